#include "solver/solid_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.h"

namespace kappaflow {
namespace {

constexpr std::uint32_t kLeafFaces = 4;

/// The point of triangle abc nearest to x (Ericson, "Real-time collision detection", 2005, section 5.1.5).
Vec3 nearest_on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const Vec3 ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax), d3 = ab.dot(bx), d4 = ac.dot(bx), d5 = ab.dot(cx),
               d6 = ac.dot(cx);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  return a + (vb * ab + vc * ac) / (va + vb + vc);
}

}  // namespace

struct SolidDistance::Search {
  Vec3 x;
  SurfacePoint best;
  double square = std::numeric_limits<double>::infinity();
  double plane = 0;  // signed distance of x from the plane of the best face

  /// Squared distances this near to each other count as equal.
  double slack() const { return 1e-10 * square; }
};

SolidDistance::SolidDistance(const TriangleSurface& surface) {
  for (const Vec3& vertex : surface.vertices)
    if (!vertex.allFinite()) throw InvalidInput("wall: a vertex is not finite");
  for (const Triangle& triangle : surface.triangles) {
    Face face;
    for (int k = 0; k < 3; ++k) {
      if (triangle[k] < 0 || static_cast<std::size_t>(triangle[k]) >= surface.vertices.size())
        throw InvalidInput(fmt::format("wall: a triangle names vertex {}; there are {}", triangle[k],
                                       surface.vertices.size()));
      face.corner[k] = surface.vertices[triangle[k]];
    }
    const Vec3 area = (face.corner[1] - face.corner[0]).cross(face.corner[2] - face.corner[0]);
    face.normal = area.stableNormalized();
    if (area.stableNorm() > 0) faces_.push_back(face);
  }
  if (faces_.empty()) throw InvalidInput("wall: no triangle has an area");
  build(0, static_cast<std::uint32_t>(faces_.size()));
}

std::uint32_t SolidDistance::build(std::uint32_t begin, std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({Eigen::AlignedBox3d(), begin, end, 0});
  for (std::uint32_t f = begin; f < end; ++f)
    for (const Vec3& corner : faces_[f].corner) nodes_[index].box.extend(corner);
  if (end - begin <= kLeafFaces) return index;
  Eigen::Index axis;
  nodes_[index].box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto center = [axis](const Face& f) {
    return f.corner[0][axis] + f.corner[1][axis] + f.corner[2][axis];
  };
  std::nth_element(faces_.begin() + begin, faces_.begin() + middle, faces_.begin() + end,
                   [&](const Face& f, const Face& g) { return center(f) < center(g); });
  build(begin, middle);
  nodes_[index].right = build(middle, end);
  return index;
}

void SolidDistance::visit(std::uint32_t index, Search& search) const {
  const Node& node = nodes_[index];
  if (node.box.squaredExteriorDistance(search.x) > search.square + search.slack()) return;
  if (node.right == 0) {
    for (std::uint32_t f = node.begin; f < node.end; ++f) {
      const Face& face = faces_[f];
      const Vec3 point = nearest_on_triangle(search.x, face.corner[0], face.corner[1], face.corner[2]);
      const double square = (search.x - point).squaredNorm();
      const double plane = face.normal.dot(search.x - face.corner[0]);
      const bool nearer = square < search.square - search.slack();
      const bool equal = !nearer && square <= search.square + search.slack();
      if (!nearer && !(equal && std::abs(plane) > std::abs(search.plane))) continue;
      search.square = std::min(square, search.square);
      search.plane = plane;
      search.best = {point, face.normal, std::copysign(std::sqrt(square), plane)};
    }
    return;
  }
  const std::uint32_t left = index + 1;
  const bool left_first = nodes_[left].box.squaredExteriorDistance(search.x) <=
                          nodes_[node.right].box.squaredExteriorDistance(search.x);
  visit(left_first ? left : node.right, search);
  visit(left_first ? node.right : left, search);
}

SurfacePoint SolidDistance::nearest(const Vec3& x) const {
  Search search{.x = x, .best = {}};
  visit(0, search);
  return search.best;
}

SurfacePoint nearest_of_union(std::span<const SolidDistance> solids, const Vec3& x) {
  SurfacePoint best{x, Vec3::Zero(), std::numeric_limits<double>::infinity()};
  for (const SolidDistance& solid : solids)
    if (const SurfacePoint point = solid.nearest(x); point.distance < best.distance) best = point;
  return best;
}

}  // namespace kappaflow
