// Method "height": every point of the surface keeps its height, as it does in a motion about the y axis.
#include "height.h"

#include <kappaflow/surface/motion/normal.h>
#include <kappaflow/surface/motion/pointwise.h>

using namespace kappaflow;

/// Eq. 4 and the shortest tangential velocity v_t for which v_y = (v_n + v_t)_y = 0:
///   v_t = -v_n,y p/|p|^2,   p the tangential part of the y axis.
/// Confidence |p|, the sine of the slope: where the surface is level, nothing along it changes a point's
/// height.
void evaluate_height(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                     VelocitySpans result) {
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    const Vec3 v_n = normal_velocity(jet, options), n = jet.g.normalized();
    const Vec3 p = Vec3::UnitY() - n.y() * n;
    const double damped = p.squaredNorm() + options.damping * options.damping;
    const Vec3 v_t = -v_n.y() / damped * p;
    return PointVelocity{v_n + limited(v_t, options.speed_limit * jet.fastest_in_reach), p.norm()};
  });
}
