// What is measured at one triangle, counter-clockwise seen from outside.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/types.h"

namespace kappaflow {

/// The triangle's area times two, outward along its normal [m2]: (b - a) x (c - a).
inline Vec3 twice_area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a);
}

/// [m2]
inline double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * twice_area_vector(a, b, c).norm();
}

/// Square of the length of the longest edge [m2].
inline double longest_edge_squared(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

/// The angle between the edges from `corner` to p and to q, in [0, pi]; 0 where one has no length.
inline double angle_at(const Vec3& corner, const Vec3& p, const Vec3& q) {
  const Vec3 u = p - corner, v = q - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

/// The cotangent of that angle; infinite or not a number in a triangle without area.
inline double cotangent_at(const Vec3& corner, const Vec3& p, const Vec3& q) {
  const Vec3 u = p - corner, v = q - corner;
  return u.dot(v) / u.cross(v).norm();
}

}  // namespace kappaflow
