// What velocity methods that look at one point at a time share: the loop over the batch, and the limit of a
// speed.
#pragma once

#include "core/shared_loop.h"
#include "surface/motion/normal.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

/// The velocity at one point [m/s] and how well its tangential part is determined, in [0, 1].
struct PointVelocity {
  Vec3 velocity = Vec3::Zero();
  double confidence = 0;
};

/// Whether the field has a gradient to speak of at this jet, i.e. whether a surface can pass there.
inline bool has_gradient(const Jet& jet) {
  constexpr double kSmallestSlope = 1e-12;  // change of f over one length scale; a surface's is about 1
  return jet.g.norm() * jet.length_scale > kSmallestSlope;
}

/// v, shortened to the length `limit` if it is longer.
inline Vec3 limited(const Vec3& v, double limit) {
  const double length = v.norm();
  return length > limit ? Vec3(limit / length * v) : v;
}

/// Calls point_velocity(x) -> PointVelocity at every point, in parallel.
template <class Evaluate>
void evaluate_each(const SurfacePoints& points, VelocitySpans result, const Evaluate& point_velocity) {
  constexpr std::size_t kPointsPerTask = 64;
  shared_for(
      points.position.size(),
      [&](std::size_t i) {
        const PointVelocity at_point = point_velocity(points.position[i]);
        result.velocity[i] = at_point.velocity;
        result.confidence[i] = at_point.confidence;
      },
      kPointsPerTask, result.velocity, result.confidence);
}

/// Calls point_velocity(x, jet) -> PointVelocity at every point where the field has a gradient; zero
/// elsewhere. Of a field with a pattern the jet is the pattern's: the velocity along the surface follows from
/// it, and Eq. 4 of the field itself goes across; where the pattern has no gradient the field is its own. As
/// far as the velocity is not determined, the pattern's own Eq. 4 has no part in what goes along the surface.
template <class Evaluate>
void evaluate_pointwise(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                        VelocitySpans result, const Evaluate& point_velocity) {
  const Field& pattern = field.pattern();
  evaluate_each(points, result, [&](const Vec3& x) -> PointVelocity {
    const Jet jet = pattern.jet(x);
    if (&pattern == &field) return has_gradient(jet) ? point_velocity(x, jet) : PointVelocity{};
    const Jet own = field.first_order_jet(x);
    if (!has_gradient(own)) return {};
    if (!has_gradient(jet)) return point_velocity(x, field.jet(x));
    PointVelocity at = point_velocity(x, jet);
    at.velocity -= (1 - at.confidence) * normal_velocity(jet, options);
    const Vec3 normal = own.g.normalized();
    at.velocity += normal_velocity(own, options) - at.velocity.dot(normal) * normal;
    return at;
  });
}

}  // namespace kappaflow
