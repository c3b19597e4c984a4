#include "tools/experiments/searched_velocity.h"

#include <algorithm>
#include <cmath>

#include "surface/motion/curvature_invariance.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"

namespace kappaflow {
namespace {

/// last: the velocity that the point had before.
PointVelocity searched(const Jet& jet, const Vec3& last, const TangentialSearch& search,
                       const VelocityOptions& options) {
  const TangentBasis basis = tangent_basis(jet.g.normalized());
  const Vec3 v_n = normal_velocity(jet, options);
  const double length = row_length(jet, options), fastest = jet.fastest_in_reach;
  const TangentialRows<2> total = total_rows(jet, basis, v_n, length);
  const TangentialRows<4> rows = stacked(total, curvature_rows(jet, basis, v_n, length));
  Vec2 start = Vec2::Zero();
  if (search.start == SearchStart::last) start = basis.transpose() * last;
  if (search.start == SearchStart::total) start = solve_damped(total, options.damping).y;
  MinimiserOptions minimiser;
  minimiser.value_tolerance = search.tolerance;
  minimiser.line_tolerance = std::max(minimiser.line_tolerance, std::sqrt(search.tolerance));
  const TangentialMinimum minimum =
      minimise(rows, options.damping, fastest, search.minimiser, start, minimiser);
  return {v_n + limited(basis * minimum.y, options.speed_limit * fastest), minimum.confidence};
}

}  // namespace

VelocityFunction searched_curvature(const TangentialSearch& search) {
  return [search, last = std::vector<Vec3>()](const Field& field, const SurfacePoints& points,
                                              const VelocityOptions& options, VelocitySpans result) mutable {
    last.resize(points.position.size(), Vec3::Zero());
    parallel_for(points.position.size(), [&](std::size_t i) {
      const Jet jet = field.jet(points.position[i]);
      const PointVelocity at_point =
          has_gradient(jet) ? searched(jet, last[i], search, options) : PointVelocity{};
      result.velocity[i] = last[i] = at_point.velocity;
      result.confidence[i] = at_point.confidence;
    });
  };
}

}  // namespace kappaflow
