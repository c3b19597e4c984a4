#include "tools/io/glb.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/errors.h"
#include "tools/io/binary.h"

namespace kappaflow {
namespace {

using Vec3f = Eigen::Vector3f;

constexpr std::uint32_t kMagic = 0x46546C67, kVersion2 = 2, kJson = 0x4E4F534A, kBinary = 0x004E4942;
constexpr int kArrayBuffer = 34962, kIndexBuffer = 34963;                 // what a view is for
constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;  // what an accessor holds

/// sRGB as linear light, in 16 bits: 8 would not tell dark colours apart.
std::uint16_t linear(std::uint8_t channel) {
  const double c = channel / 255.0;
  return static_cast<std::uint16_t>(
      std::lround(65535 * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4))));
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

Contents contents_of(const TexturedMesh& mesh, const Vec3& origin) {
  Contents all;
  const std::size_t n = mesh.position.size();
  const auto add_vectors = [&](std::span<const Vec3> vectors, const Vec3& from, const std::string& further) {
    const std::size_t begin = all.bytes.size();
    for (const Vec3& v : vectors)
      for (const double c : Vec3(v - from)) append(all.bytes, static_cast<float>(c));
    all.describe(begin, kArrayBuffer, kFloat, "VEC3", n, further);
  };
  add_vectors(mesh.position, origin, ends_of(mesh.position, origin));
  add_vectors(mesh.normal, Vec3::Zero(), "");
  std::size_t begin = all.bytes.size();
  for (const Vec2& t : mesh.texture) {
    append(all.bytes, static_cast<float>(t[0]));
    append(all.bytes, static_cast<float>(1 - t[1]));
  }
  all.describe(begin, kArrayBuffer, kFloat, "VEC2", n);
  begin = all.bytes.size();
  for (const Rgb& colour : mesh.colour) {
    for (const std::uint8_t channel : colour) append(all.bytes, linear(channel));
    append(all.bytes, std::uint16_t{65535});
  }
  all.describe(begin, kArrayBuffer, kUnsignedShort, "VEC4", n, R"(,"normalized":true)");
  begin = all.bytes.size();
  for (const Triangle& triangle : mesh.triangles)
    for (const int v : triangle) append(all.bytes, static_cast<std::uint32_t>(v));
  all.describe(begin, kIndexBuffer, kUnsignedInt, "SCALAR", 3 * mesh.triangles.size());
  return all;
}

/// Of the scene's only node. A number is written with as many digits as it takes to read it back.
std::string translation_of(const Vec3& origin) {
  if (origin.isZero(0)) return "";
  return fmt::format(R"(,"translation":[{},{},{}])", origin[0], origin[1], origin[2]);
}

std::string json_of(const Contents& all, const Vec3& origin) {
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"kappaflow"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0{}}}],"meshes":[{{"primitives":[{{"attributes":)"
      R"({{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}},"indices":4,"material":0}}]}}],)"
      R"("materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0.6}}}}],)"
      R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}})",
      translation_of(origin), all.bytes.size(), all.views, all.accessors);
}

void append_chunk(std::string& bytes, std::uint32_t kind, const std::string& content) {
  append(bytes, static_cast<std::uint32_t>(content.size()));
  append(bytes, kind);
  bytes += content;
}

/// What positions are stored as distances from: single precision holds seven digits, of which a mesh far from
/// the origin would waste most on where it is. The middle of such a mesh, as a number of single precision;
/// else the origin itself.
Vec3 far_origin(std::span<const Vec3> position) {
  constexpr double kFar =
      16;  // in sizes of the mesh: up to there its positions are right to a millionth of it
  const Bounds box = bounding_box(position);
  const Vec3 middle = (box.lower + box.upper) / 2;
  if (!(middle.lpNorm<Eigen::Infinity>() > kFar * (box.upper - box.lower).maxCoeff())) return Vec3::Zero();
  return middle.cast<float>().cast<double>();
}

}  // namespace

void check_glb_size(std::size_t vertices, std::size_t triangles) {
  constexpr std::size_t kBytesPerVertex = 3 * 4 + 3 * 4 + 2 * 4 + 4 * 2, kBytesPerTriangle = 3 * 4;
  constexpr std::size_t kRest = 4096;  // what describes them takes less
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() - kRest;
  if (vertices > kMost / kBytesPerVertex ||
      triangles > (kMost - vertices * kBytesPerVertex) / kBytesPerTriangle)
    throw InvalidInput(
        fmt::format("a .glb file holds at most 4 GiB: not a mesh of {} vertices and {} triangles; "
                    ".ply and .obj have no such limit",
                    vertices, triangles));
}

std::string glb_bytes(const TexturedMesh& mesh) {
  check_glb_size(mesh.position.size(), mesh.triangles.size());
  const bool empty = mesh.triangles.empty();
  const Vec3 origin = far_origin(mesh.position);
  const Contents all = empty ? Contents{} : contents_of(mesh, origin);
  std::string json = empty ? R"({"asset":{"version":"2.0","generator":"kappaflow"}})" : json_of(all, origin);
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
