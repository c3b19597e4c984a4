// The sign after Baerentzen & Aanaes, "Signed distance computation using the angle weighted pseudonormal",
// 2005.
#include "core/solid_distance.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/errors.h"
#include "core/nearest_on_triangle.h"

namespace kappaflow {
namespace {

using enum NearestOnTriangle::Feature;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLeafTriangles = 4;
constexpr std::size_t kMaxTreeDepth = 64;  // the median split halves the triangles, so 2^64 would fit

double angle_at(const Vec3& corner, const Vec3& p, const Vec3& q) {
  const Vec3 u = p - corner, v = q - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// One entry per triangle side, sorted so that the two sides of an edge follow each other.
struct Side {
  std::pair<int, int> edge;  // smaller vertex first
  std::size_t triangle;
  int k;
};

std::vector<Side> sorted_sides(const TriangleSurface& surface) {
  std::vector<Side> sides;
  sides.reserve(3 * surface.triangles.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = surface.triangles[t][k], b = surface.triangles[t][(k + 1) % 3];
      sides.push_back({std::minmax({a, b}), t, k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.edge, a.triangle, a.k) < std::tie(b.edge, b.triangle, b.k);
  });
  return sides;
}

void check(const TriangleSurface& surface) {
  for (const Vec3& vertex : surface.vertices)
    if (!vertex.allFinite()) throw InvalidInput("wall: a vertex is not finite");
  const std::size_t vertices = surface.vertices.size();
  for (const Triangle& triangle : surface.triangles)
    for (const int v : triangle)
      if (v < 0 || static_cast<std::size_t>(v) >= vertices)
        throw InvalidInput(fmt::format("wall: a triangle names vertex {}; there are {}", v, vertices));
}

}  // namespace

SolidDistance::SolidDistance(const TriangleSurface& surface) {
  check(surface);
  set_faces(surface);
  std::erase_if(faces_, [](const Face& f) { return f.normal[face].isZero(0); });
  if (faces_.empty()) throw InvalidInput("wall: no triangle has an area");
  build(0, static_cast<std::uint32_t>(faces_.size()));
}

/// The triangles with the pseudonormals of their faces, edges (sum of both sides' normals) and corners (sum
/// over the triangles around, weighted with their angles there).
void SolidDistance::set_faces(const TriangleSurface& surface) {
  faces_.resize(surface.triangles.size());
  std::vector<Vec3> vertex_normal(surface.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < faces_.size(); ++t) {
    auto& [corner, normal] = faces_[t];
    for (int k = 0; k < 3; ++k) corner[k] = surface.vertices[surface.triangles[t][k]];
    normal[face] = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    for (int k = 0; k < 3; ++k)
      vertex_normal[surface.triangles[t][k]] +=
          angle_at(corner[k], corner[(k + 1) % 3], corner[(k + 2) % 3]) * normal[face];
  }
  for (std::size_t t = 0; t < faces_.size(); ++t)
    for (int k = 0; k < 3; ++k) faces_[t].normal[corner_0 + k] = vertex_normal[surface.triangles[t][k]];

  const std::vector<Side> sides = sorted_sides(surface);
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    Vec3 sum = Vec3::Zero();
    for (; last < sides.size() && sides[last].edge == sides[first].edge; ++last)
      sum += faces_[sides[last].triangle].normal[face];
    for (std::size_t s = first; s < last; ++s) faces_[sides[s].triangle].normal[edge_0 + sides[s].k] = sum;
  }
}

std::uint32_t SolidDistance::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node{Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity), begin, end, 0};
  for (std::uint32_t t = begin; t < end; ++t)
    for (const Vec3& corner : faces_[t].corner) {
      node.lower = node.lower.cwiseMin(corner);
      node.upper = node.upper.cwiseMax(corner);
    }
  nodes_.push_back(node);
  if (end - begin <= kLeafTriangles) return index;
  split(begin, end, node);
  const std::uint32_t middle = begin + (end - begin) / 2;
  build(begin, middle);
  const std::uint32_t second = build(middle, end);
  nodes_[index].second = second;
  return index;
}

void SolidDistance::split(std::uint32_t begin, std::uint32_t end, const Node& node) {
  Eigen::Index axis = 0;
  (node.upper - node.lower).maxCoeff(&axis);
  const auto center = [axis](const Face& t) {
    return t.corner[0][axis] + t.corner[1][axis] + t.corner[2][axis];
  };
  std::nth_element(faces_.begin() + begin, faces_.begin() + begin + (end - begin) / 2, faces_.begin() + end,
                   [&](const Face& a, const Face& b) { return center(a) < center(b); });
}

SurfacePoint SolidDistance::nearest(const Vec3& x) const {
  double least = kInfinity;
  SurfacePoint best;
  Vec3 normal = Vec3::Zero();
  std::array<std::uint32_t, kMaxTreeDepth> stack{0};
  for (std::size_t size = 1; size > 0;) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (node.squared_distance(x) > least) continue;
    if (node.second != 0) {  // the nearer child comes off the stack first
      const bool swap = nodes_[node.second].squared_distance(x) < nodes_[index + 1].squared_distance(x);
      stack[size++] = swap ? index + 1 : node.second;
      stack[size++] = swap ? node.second : index + 1;
      continue;
    }
    for (std::uint32_t f = node.begin; f < node.end; ++f) {
      const auto [point, feature] = nearest_on_triangle(faces_[f].corner, x);
      if (const double square = (x - point).squaredNorm(); square < least) {
        least = square;
        best.position = point;
        best.normal = faces_[f].normal[face];
        normal = faces_[f].normal[feature];
      }
    }
  }
  best.distance = std::copysign(std::sqrt(least), normal.dot(x - best.position));
  return best;
}

SurfacePoint nearest_of_union(std::span<const SolidDistance> solids, const Vec3& x) {
  SurfacePoint best{x, Vec3::Zero(), kInfinity};
  for (const SolidDistance& solid : solids)
    if (const SurfacePoint point = solid.nearest(x); point.distance < best.distance) best = point;
  return best;
}

}  // namespace kappaflow
