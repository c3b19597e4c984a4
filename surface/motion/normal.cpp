#include "surface/motion/normal.h"

#include "surface/motion/pointwise.h"

namespace kappaflow {

Vec3 normal_velocity(const Jet& jet, const VelocityOptions& options) {
  return limited(-jet.f_t / jet.g.squaredNorm() * jet.g, options.speed_limit * jet.fastest_in_reach);
}

void evaluate_normal(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                     VelocitySpans result) {
  evaluate_each(points, result, [&](const Vec3& x) -> PointVelocity {
    const Jet jet = field.first_order_jet(x);
    return {.velocity = has_gradient(jet) ? normal_velocity(jet, options) : Vec3(Vec3::Zero()),
            .confidence = 0};
  });
}

}  // namespace kappaflow
