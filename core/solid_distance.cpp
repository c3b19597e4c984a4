// The sign after Baerentzen & Aanaes, "Signed distance computation using the angle weighted pseudonormal",
// 2005.
#include "core/solid_distance.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/connectivity.h"
#include "core/errors.h"
#include "core/triangle_geometry.h"

namespace kappaflow {
namespace {

using enum NearestOnTriangle::Feature;

/// Of each triangle: the pseudonormals of its face, edges (sum of both sides' normals) and corners (sum over
/// the triangles around, weighted with their angles there), by NearestOnTriangle::Feature.
std::vector<std::array<Vec3, 7>> pseudonormals(const TriangleSurface& surface) {
  std::vector<std::array<Vec3, 7>> normals(surface.triangles.size());
  std::vector<Vec3> vertex_normal(surface.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < normals.size(); ++t) {
    const Triangle& triangle = surface.triangles[t];
    const auto corner = [&](int k) -> const Vec3& { return surface.vertices[triangle[k % 3]]; };
    normals[t][face] = twice_area_vector(corner(0), corner(1), corner(2)).normalized();
    for (int k = 0; k < 3; ++k)
      vertex_normal[triangle[k]] += angle_at(corner(k), corner(k + 1), corner(k + 2)) * normals[t][face];
  }
  for (std::size_t t = 0; t < normals.size(); ++t)
    for (int k = 0; k < 3; ++k) normals[t][corner_0 + k] = vertex_normal[surface.triangles[t][k]];

  const EdgeSides sides(surface.triangles);
  for (std::size_t e = 0; e < sides.edges(); ++e) {
    Vec3 sum = Vec3::Zero();
    for (const int h : sides.of(e)) sum += normals[h / 3][face];
    for (const int h : sides.of(e)) normals[h / 3][edge_0 + h % 3] = sum;
  }
  return normals;
}

}  // namespace

void check_surface(const TriangleSurface& surface) {
  for (const Vec3& vertex : surface.vertices)
    if (!vertex.allFinite()) throw InvalidInput("wall: a vertex is not finite");
  const std::size_t vertices = surface.vertices.size();
  for (const Triangle& triangle : surface.triangles)
    for (const int v : triangle)
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        throw InvalidInput(fmt::format("wall: a triangle names vertex {}; there are {}", v, vertices));
}

SolidDistance::SolidDistance(const TriangleSurface& surface) {
  check_surface(surface);
  const std::vector<Normals> normals = pseudonormals(surface);
  std::vector<TriangleTree::Corners> corners;
  for (std::size_t t = 0; t < normals.size(); ++t) {
    if (normals[t][face].isZero(0)) continue;
    const auto& [a, b, c] = surface.triangles[t];
    corners.push_back({surface.vertices[a], surface.vertices[b], surface.vertices[c]});
    normals_.push_back(normals[t]);
  }
  if (corners.empty()) throw InvalidInput("wall: no triangle has an area");
  tree_.emplace(corners);
}

SurfacePoint SolidDistance::nearest(const Vec3& x) const {
  const TriangleTree::Nearest found = tree_->nearest(x);
  const Normals& normals = normals_[found.triangle];
  const Vec3& point = found.at.point;
  const double side = normals[found.at.feature].dot(x - point);
  return {point, normals[face], std::copysign(std::sqrt(found.square), side)};
}

SurfacePoint nearest_of_union(std::span<const SolidDistance> solids, const Vec3& x) {
  SurfacePoint best{x, Vec3::Zero(), kInfinity};
  for (const SolidDistance& solid : solids)
    if (const SurfacePoint point = solid.nearest(x); point.distance < best.distance) best = point;
  return best;
}

}  // namespace kappaflow
