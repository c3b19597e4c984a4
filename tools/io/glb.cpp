#include "tools/io/glb.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/errors.h"
#include "tools/io/binary.h"
#include "tools/io/exported_arrays.h"

namespace kappaflow {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr std::uint32_t kMagic = 0x46546C67, kVersion2 = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
constexpr int kArrayBuffer = 34962, kIndexBuffer = 34963;                 // what a view is for
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;  // what an accessor holds

/// sRGB as linear light, in 16 bits: 8 would not tell dark colours apart.
std::uint16_t linear(std::uint8_t channel) {
  return static_cast<std::uint16_t>(std::lround(65535 * linear_light(channel)));
}

/// The arrays, one behind the other, and their descriptions.
struct Contents {
  std::string bytes, views, accessors;

  /// The bytes since `begin` become the next view and accessor. further: members of the accessor.
  void describe(std::size_t begin, int target, int component, const char* type, std::size_t count,
                const std::string& further = {}) {
    const char* comma = views.empty() ? "" : ",";
    views += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}})", comma, begin,
                         bytes.size() - begin, target);
    accessors += fmt::format(R"({0}{{"bufferView":{1},"componentType":{2},"count":{3},"type":"{4}"{5}}})",
                             comma, next++, component, count, type, further);
  }
  int next = 0;
};

std::string ends_of(std::span<const Vec3> position, const Vec3& origin) {
  Vec3f lower = Vec3f::Constant(std::numeric_limits<float>::max()), upper = -lower;
  for (const Vec3& x : position) {
    lower = lower.cwiseMin((x - origin).cast<float>());
    upper = upper.cwiseMax((x - origin).cast<float>());
  }
  return fmt::format(R"(,"min":[{:.9g},{:.9g},{:.9g}],"max":[{:.9g},{:.9g},{:.9g}])", lower[0], lower[1],
                     lower[2], upper[0], upper[1], upper[2]);
}

/// The vertex of each entry of the texture coordinates. In the file these are the vertices: glTF has one
/// index for all that a corner has.
std::vector<std::size_t> vertex_of_entries(const TexturedMesh& mesh) {
  std::vector<std::size_t> vertex(mesh.texture.size());
  std::iota(vertex.begin(), vertex.end(), std::size_t{0});
  for (std::size_t t = 0; t < mesh.corners.size(); ++t)
    for (int c = 0; c < 3; ++c) vertex[mesh.corners[t][c]] = mesh.triangles[t][c];
  return vertex;
}

void add_vectors(Contents& all, std::span<const Vec3> vectors, const Vec3& from,
                 std::span<const std::size_t> vertex, const std::string& further) {
  const std::size_t begin = all.bytes.size();
  for (const std::size_t v : vertex)
    for (const double c : Vec3(vectors[v] - from)) append(all.bytes, static_cast<float>(c));
  all.describe(begin, kArrayBuffer, kFloat, "VEC3", vertex.size(), further);
}

void add_texture(Contents& all, std::span<const Vec2> texture) {
  const std::size_t begin = all.bytes.size();
  for (const Vec2& t : texture) {
    append(all.bytes, static_cast<float>(t[0]));
    append(all.bytes, static_cast<float>(1 - t[1]));
  }
  all.describe(begin, kArrayBuffer, kFloat, "VEC2", texture.size());
}

void add_colours(Contents& all, std::span<const Rgb> colour, std::span<const std::size_t> vertex) {
  const std::size_t begin = all.bytes.size();
  for (const std::size_t v : vertex) {
    for (const std::uint8_t channel : colour[v]) append(all.bytes, linear(channel));
    append(all.bytes, std::uint16_t{65535});
  }
  all.describe(begin, kArrayBuffer, kUnsignedShort, "VEC4", vertex.size(), R"(,"normalized":true)");
}

void add_triangles(Contents& all, std::span<const Triangle> triangles) {
  const std::size_t begin = all.bytes.size();
  for (const Triangle& triangle : triangles)
    for (const int v : triangle) append(all.bytes, static_cast<std::uint32_t>(v));
  all.describe(begin, kIndexBuffer, kUnsignedInt, "SCALAR", 3 * triangles.size());
}

/// glTF has no whole numbers of 32 bits but for indices. Rest positions are from where positions are.
void add_array(Contents& all, const PointArray& array, const Vec3& origin,
               std::span<const std::size_t> vertex) {
  const std::size_t begin = all.bytes.size(), n = array.components;
  const bool is_position = is_rest_position(array);
  for (const std::size_t v : vertex)
    for (std::size_t c = 0; c < n; ++c) {
      const double from = is_position ? origin[static_cast<Eigen::Index>(c)] : 0;
      append(all.bytes, static_cast<float>(array.values[n * v + c] - from));
    }
  constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  all.describe(begin, kArrayBuffer, kFloat, kTypes[n - 1], vertex.size());
}

/// glTF has numbers, pairs, triples and quadruples.
std::vector<PointArray> arrays_to_write(const TexturedMesh& mesh) {
  std::vector<PointArray> arrays;
  for (const PointArray& array : mesh.arrays)
    if (array.components <= 4) arrays.push_back(array);
  return arrays;
}

Contents contents_of(const TexturedMesh& mesh, const Vec3& origin) {
  const std::vector<std::size_t> vertex = vertex_of_entries(mesh);
  std::vector<Vec3> position;
  position.reserve(vertex.size());
  for (const std::size_t v : vertex) position.push_back(mesh.position[v]);
  Contents all;
  add_vectors(all, mesh.position, origin, vertex, ends_of(position, origin));
  add_vectors(all, mesh.normal, Vec3::Zero(), vertex, "");
  add_texture(all, mesh.texture);
  add_colours(all, mesh.colour, vertex);
  add_triangles(all, mesh.corners.empty() ? mesh.triangles : mesh.corners);
  for (const PointArray& array : arrays_to_write(mesh)) add_array(all, array, origin, vertex);
  return all;
}

/// Of the attributes that are not the format's own: it wants an underscore before their names.
std::string further_attributes(const TexturedMesh& mesh) {
  std::string text;
  int accessor = 5;  // after positions, normals, texture coordinates, colours and indices
  for (const PointArray& array : arrays_to_write(mesh)) {
    std::string name = array.name;
    for (char& c : name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    text += fmt::format(R"(,"_{}":{})", name, accessor++);
  }
  return text;
}

/// Of the scene's only node: glTF has y up. A number is written with as many digits as it takes to read it
/// back.
std::string placement_of(const Vec3& origin, bool z_up) {
  const Vec3 at = z_up ? Vec3(origin.x(), origin.z(), 0 - origin.y()) : origin;
  std::string text;
  if (!origin.isZero(0)) text = fmt::format(R"(,"translation":[{},{},{}])", at[0], at[1], at[2]);
  if (z_up) text += fmt::format(R"(,"rotation":[{0},0,0,{1}])", -std::sqrt(0.5), std::sqrt(0.5));
  return text;
}

std::string json_of(const Contents& all, const TexturedMesh& mesh, const Vec3& origin) {
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"kappaflow"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0{}}}],"meshes":[{{"primitives":[{{"attributes":)"
      R"({{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3{}}},"indices":4,"material":0}}]}}],)"
      R"("materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0.6}}}}],)"
      R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}})",
      placement_of(origin, mesh.z_up), further_attributes(mesh), all.bytes.size(), all.views, all.accessors);
}

void append_chunk(std::string& bytes, std::uint32_t kind, const std::string& content) {
  append(bytes, static_cast<std::uint32_t>(content.size()));
  append(bytes, kind);
  bytes += content;
}

}  // namespace

void check_glb_size(std::size_t vertices, std::size_t triangles, std::size_t further_numbers) {
  const std::size_t bytes_per_vertex = 3 * 4 + 3 * 4 + 2 * 4 + 4 * 2 + 4 * further_numbers;
  constexpr std::size_t kBytesPerTriangle = 3 * 4;
  constexpr std::size_t kRest = 4096;  // what describes them takes less
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - kRest;
  if (vertices > kMost / bytes_per_vertex ||
      triangles > (kMost - vertices * bytes_per_vertex) / kBytesPerTriangle)
    throw InvalidInput(
        fmt::format("a .glb file holds at most 4 GiB: not a mesh of {} vertices and {} triangles; "
                    ".ply and .obj have no such limit",
                    vertices, triangles));
}

std::string glb_bytes(const TexturedMesh& mesh) {
  std::size_t further_numbers = 0;
  for (const PointArray& array : mesh.arrays) further_numbers += array.components;
  check_glb_size(mesh.texture.size(), mesh.triangles.size(), further_numbers);
  const bool empty = mesh.triangles.empty();
  const Vec3 origin = far_origin(mesh.position);
  const Contents all = empty ? Contents{} : contents_of(mesh, origin);
  std::string json =
      empty ? R"({"asset":{"version":"2.0","generator":"kappaflow"}})" : json_of(all, mesh, origin);
  json.resize((json.size() + 3) / 4 * 4, ' ');  // chunks are multiples of four bytes; that of arrays is one
  std::string chunks, bytes;
  append_chunk(chunks, kJson, json);
  if (!empty) append_chunk(chunks, kBinary, all.bytes);
  append(bytes, kMagic);
  append(bytes, kVersion2);
  append(bytes, static_cast<std::uint32_t>(3 * sizeof(std::uint32_t) + chunks.size()));
  return bytes + chunks;
}

}  // namespace kappaflow
