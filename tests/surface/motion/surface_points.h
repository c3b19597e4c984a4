// Points on the surface of a field, for the tests of the velocity methods.
#pragma once

#include <random>
#include <vector>

#include "surface/field/particle_field.h"
#include "surface/motion/velocity_methods.h"

namespace kappaflow::testing {

/// Points on f = 0, spread evenly over its area: uniform random points of a thin shell around the surface,
/// projected by Eq. 11 to rounding.
inline std::vector<Vec3> surface_points(const Field& field, std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  const Bounds bounds = field.bounds();
  const double shell = 0.02 * field.length_scale();
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  while (points.size() < count) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = bounds.lower[a] + unit(random) * (bounds.upper - bounds.lower)[a];
    ValueAndGradient at = field.value_and_gradient(x);
    if (!(std::abs(at.f) < shell * at.g.norm())) continue;
    for (int i = 0; i < 8; ++i, at = field.value_and_gradient(x)) x -= at.f / at.g.squaredNorm() * at.g;
    if (std::abs(at.f) < 1e-12) points.push_back(x);
  }
  return points;
}

/// A method's velocities at points that need no neighbourhood.
inline SurfaceVelocities velocities_at(const Field& field, const VelocityFunction& evaluate,
                                       const std::vector<Vec3>& points, const VelocityOptions& options) {
  const std::vector<double> area(points.size(), 0.0);
  const VertexRings rings{.start = std::vector<int>(points.size() + 1, 0), .neighbour = {}};
  SurfaceVelocities result;
  evaluate(field, {.position = points, .area = area, .rings = rings}, options, result.sized(points.size()));
  return result;
}

inline SurfaceVelocities velocities_at(const Field& field, std::string_view method,
                                       const std::vector<Vec3>& points, const VelocityOptions& options) {
  return velocities_at(field, velocity_method(method).evaluate, points, options);
}

}  // namespace kappaflow::testing
