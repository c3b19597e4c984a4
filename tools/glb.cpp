#include "tools/glb.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tools/binary.h"

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

std::string ends_of(std::span<const Vec3> position) {
  Vec3f lower = Vec3f::Constant(std::numeric_limits<float>::max()), upper = -lower;
  for (const Vec3& x : position) {
    lower = lower.cwiseMin(x.cast<float>());
    upper = upper.cwiseMax(x.cast<float>());
  }
  return fmt::format(R"(,"min":[{:.9g},{:.9g},{:.9g}],"max":[{:.9g},{:.9g},{:.9g}])", lower[0], lower[1],
                     lower[2], upper[0], upper[1], upper[2]);
}

Contents contents_of(const TexturedMesh& mesh) {
  Contents all;
  const std::size_t n = mesh.position.size();
  const auto add_vectors = [&](std::span<const Vec3> vectors, const std::string& further) {
    const std::size_t begin = all.bytes.size();
    for (const Vec3& v : vectors)
      for (const double c : v) append(all.bytes, static_cast<float>(c));
    all.describe(begin, kArrayBuffer, kFloat, "VEC3", n, further);
  };
  add_vectors(mesh.position, ends_of(mesh.position));
  add_vectors(mesh.normal, "");
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

std::string json_of(const Contents& all) {
  return fmt::format(
      R"({{"asset":{{"version":"2.0","generator":"kappaflow"}},"scene":0,"scenes":[{{"nodes":[0]}}],)"
      R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":)"
      R"({{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2,"COLOR_0":3}},"indices":4,"material":0}}]}}],)"
      R"("materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":0.6}}}}],)"
      R"("buffers":[{{"byteLength":{}}}],"bufferViews":[{}],"accessors":[{}]}})",
      all.bytes.size(), all.views, all.accessors);
}

void append_chunk(std::string& bytes, std::uint32_t kind, const std::string& content) {
  append(bytes, static_cast<std::uint32_t>(content.size()));
  append(bytes, kind);
  bytes += content;
}

}  // namespace

std::string glb_bytes(const TexturedMesh& mesh) {
  const bool empty = mesh.triangles.empty();
  const Contents all = empty ? Contents{} : contents_of(mesh);
  std::string json = empty ? R"({"asset":{"version":"2.0","generator":"kappaflow"}})" : json_of(all);
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
