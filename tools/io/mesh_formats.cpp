#include "tools/io/mesh_formats.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "core/whole_within.h"
#include "tools/io/binary.h"
#include "tools/io/exported_arrays.h"
#include "tools/io/glb.h"

namespace kappaflow {
namespace {

/// Digits of a coordinate: nine, and as many more as tell where a mesh far from the origin is.
int digits_of(std::span<const Vec3> position) {
  const auto [lower, upper] = bounding_box(position);
  const double farthest = lower.cwiseAbs().cwiseMax(upper.cwiseAbs()).maxCoeff();
  return whole_within(std::ceil(9 + std::log10(farthest / (upper - lower).maxCoeff())), 9, 17);
}

std::string obj_text(const TexturedMesh& mesh) {
  const int digits = digits_of(mesh.position);
  std::string text;
  const auto out = std::back_inserter(text);
  for (std::size_t v = 0; v < mesh.position.size(); ++v) {
    const Vec3& x = mesh.position[v];
    const Rgb& c = mesh.colour[v];
    fmt::format_to(out, "v {1:.{0}g} {2:.{0}g} {3:.{0}g} {4:.3f} {5:.3f} {6:.3f}\n", digits, x[0], x[1], x[2],
                   c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
  }
  for (const Vec2& t : mesh.texture) fmt::format_to(out, "vt {:.7g} {:.7g}\n", t[0], t[1]);
  for (const Vec3& n : mesh.normal) fmt::format_to(out, "vn {:.6g} {:.6g} {:.6g}\n", n[0], n[1], n[2]);
  const std::span<const Triangle> corners = mesh.corners.empty() ? mesh.triangles : mesh.corners;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle &v = mesh.triangles[t], &vt = corners[t];
    fmt::format_to(out, "f {0}/{3}/{0} {1}/{4}/{1} {2}/{5}/{2}\n", v[0] + 1, v[1] + 1, v[2] + 1, vt[0] + 1,
                   vt[1] + 1, vt[2] + 1);
  }
  return text;
}

std::string_view ply_type(NumberType type) {
  switch (type) {
    case NumberType::uint8:
      return "uchar";
    case NumberType::int32:
    case NumberType::int64:
      return "int";
    case NumberType::float64:
      return "double";
    default:
      return "float";
  }
}

std::string ply_properties(const PointArray& array) {
  if (array.components == 1) return fmt::format("property {} {}\n", ply_type(array.type), array.name);
  std::string text;
  for (std::size_t c = 0; c < array.components; ++c)
    text += fmt::format("property {} {}_{}\n", ply_type(array.type), array.name,
                        array.components <= 3 ? std::string(1, "xyz"[c]) : std::to_string(c));
  return text;
}

void append_tuple(std::string& bytes, const PointArray& array, std::size_t vertex) {
  for (std::size_t c = 0; c < array.components; ++c) {
    const double value = array.values[vertex * array.components + c];
    const std::string_view type = ply_type(array.type);
    if (type == "uchar") append(bytes, static_cast<std::uint8_t>(value));
    if (type == "int") append(bytes, whole_of_32_bits(value));
    if (type == "float") append(bytes, static_cast<float>(value));
    if (type == "double") append(bytes, value);
  }
}

std::string ply_bytes(const TexturedMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment kappaflow\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\n"
      "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n",
      mesh.position.size());
  for (const PointArray& array : mesh.arrays) bytes += ply_properties(array);
  bytes += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                       mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.position.size(); ++v) {
    for (const double x : mesh.position[v]) append(bytes, x);
    for (const double n : mesh.normal[v]) append(bytes, static_cast<float>(n));
    for (const double t : mesh.texture[v]) append(bytes, static_cast<float>(t));
    for (const std::uint8_t c : mesh.colour[v]) append(bytes, c);
    for (const PointArray& array : mesh.arrays) append_tuple(bytes, array, v);
  }
  for (const Triangle& triangle : mesh.triangles) {
    append(bytes, std::uint8_t{3});
    for (const int v : triangle) append(bytes, v);
  }
  return bytes;
}

}  // namespace

std::string mesh_bytes(MeshFormat format, const TexturedMesh& mesh) {
  switch (format) {
    case MeshFormat::obj:
      return obj_text(mesh);
    case MeshFormat::ply:
      return ply_bytes(mesh);
    case MeshFormat::glb:
      return glb_bytes(mesh);
    case MeshFormat::usd:
      break;
  }
  return {};
}

}  // namespace kappaflow
