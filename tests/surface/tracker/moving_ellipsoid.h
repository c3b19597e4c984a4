// A body whose motion is known.
#pragma once

#include <memory>

#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow::testing {

/// An ellipsoid that turns with a constant angular velocity while its centre moves.
inline auto moving_ellipsoid(double t0, double t1) {
  return FunctionMotion(t0, t1, [](double t) -> std::shared_ptr<const Field> {
    const Vec3 velocity(0.3, -0.1, 0.2), spin(0.6, 1.1, -0.7);
    return std::make_shared<EllipsoidField>(velocity * t, rotation(spin * t), Vec3(1, 0.7, 0.5), velocity,
                                            spin, t);
  });
}

/// Where it takes the point x of its start by time t.
inline Vec3 moved_with_ellipsoid(const Vec3& x, double t) {
  return Vec3(0.3, -0.1, 0.2) * t + rotation(Vec3(0.6, 1.1, -0.7) * t) * x;
}

}  // namespace kappaflow::testing
