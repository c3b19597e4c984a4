#include "surface/motion/normal.h"

#include "surface/motion/pointwise.h"

namespace kappaflow {

Vec3 normal_velocity(const Jet& jet, const VelocityOptions& options) {
  return limited(-jet.f_t / jet.g.squaredNorm() * jet.g, options.speed_limit * jet.fastest_in_reach);
}

void evaluate_normal(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                     VelocitySpans result) {
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    return PointVelocity{.velocity = normal_velocity(jet, options), .confidence = 0};
  });
}

}  // namespace kappaflow
