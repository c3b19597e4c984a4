// Points spread evenly over a sphere.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Points spread evenly over the unit sphere, turned about `axis` by `angle`.
inline std::vector<Vec3> fibonacci_sphere(int count, const Vec3& axis, double angle) {
  const double golden = std::numbers::pi * (1 + std::sqrt(5.0));
  const Eigen::AngleAxisd turn(angle, axis.normalized());
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), phi = golden * (i + 0.5);
    points.emplace_back(turn * Vec3(r * std::cos(phi), r * std::sin(phi), z));
  }
  return points;
}

}  // namespace kappaflow
