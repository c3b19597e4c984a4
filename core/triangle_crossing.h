// Whether two triangles of a mesh pass through each other: an edge crosses a triangle where its ends lie on
// opposite sides of its plane and the edge sees the triangle's corners turn one way (signed volumes, Segura &
// Feito 2001).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <span>

#include "core/types.h"

namespace kappaflow {

namespace triangle_crossing {

inline double signed_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Which side of the plane of the triangle t the point x is on: a signed volume, 0 where rounding might
/// decide, as it would on the flat sides of a solid.
inline double side_of(const std::array<Vec3, 3>& t, const Vec3& x) {
  constexpr double kRounding = 1e-14;
  const Vec3 u = t[1] - t[0], v = t[2] - t[0], w = x - t[0];
  const double volume = u.cross(v).dot(w);
  const double sure = kRounding * kRounding * u.squaredNorm() * v.squaredNorm() * w.squaredNorm();
  return volume * volume > sure ? volume : 0;
}

/// Whether the edge from p to q crosses the triangle t, its rim included: else it would slip through between
/// two that share the rim.
inline bool crosses(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  if (!(side_of(t, p) * side_of(t, q) < 0)) return false;
  const double a = signed_volume(p, q, t[0], t[1]), b = signed_volume(p, q, t[1], t[2]),
               c = signed_volume(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Whether an edge of a that has no vertex in common with b crosses b; false where they share two vertices.
inline bool edges_cross(const Triangle& a, const std::array<Vec3, 3>& at_a, const Triangle& b,
                        const std::array<Vec3, 3>& at_b) {
  std::array<bool, 3> shared;
  for (int i = 0; i < 3; ++i) shared[i] = std::ranges::find(b, a[i]) != b.end();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (!shared[i] && !shared[j] && crosses(at_a[i], at_a[j], at_b)) return true;
  }
  return false;
}

}  // namespace triangle_crossing

/// Whether an edge of one crosses the other. Triangles that share an edge do not; of those that share one
/// vertex, only the edges opposite to it can. In double precision: where an edge meets a triangle's rim
/// within rounding, about 1e-15 of the coordinates, the answer may be either; one that lies in its plane
/// within that does not cross it.
inline bool triangles_cross(const Triangle& a, const std::array<Vec3, 3>& at_a, const Triangle& b,
                            const std::array<Vec3, 3>& at_b) {
  return triangle_crossing::edges_cross(a, at_a, b, at_b) || triangle_crossing::edges_cross(b, at_b, a, at_a);
}
inline bool triangles_cross(std::span<const Vec3> position, const Triangle& a, const Triangle& b) {
  return triangles_cross(a, {position[a[0]], position[a[1]], position[a[2]]}, b,
                         {position[b[0]], position[b[1]], position[b[2]]});
}

}  // namespace kappaflow
