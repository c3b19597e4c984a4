#include "surface/motion/curvature_invariance.h"

#include "surface/field/curvature.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"

namespace kappaflow {

TangentialRows<2> curvature_rows(const Jet& jet, const TangentBasis& basis, const Vec3& normal_velocity,
                                 double length) {
  const CurvatureJet c = curvature_jet(jet);
  const double scale_K = length * length * length, scale_H = length * length;
  TangentialRows<2> rows;
  rows.R.row(0) = scale_K * c.grad_K.transpose() * basis;
  rows.R.row(1) = scale_H * c.grad_H.transpose() * basis;
  rows.b = -Vec2(scale_K * (c.grad_K.dot(normal_velocity) + c.K_t),
                 scale_H * (c.grad_H.dot(normal_velocity) + c.H_t));
  return rows;
}

void evaluate_curvature_only(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                             VelocitySpans result) {
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, options);
    return with_tangential(v_n, basis, curvature_rows(jet, basis, v_n, row_length(jet, options)), jet,
                           options);
  });
}

void evaluate_curvature(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                        VelocitySpans result) {
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, options);
    const double length = row_length(jet, options);
    const TangentialRows<4> rows =
        stacked(total_rows(jet, basis, v_n, length), curvature_rows(jet, basis, v_n, length));
    return with_tangential(v_n, basis, rows, jet, options);
  });
}

void evaluate_curvature_first(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                              VelocitySpans result) {
  constexpr double kUndetermined = 3;  // [dampings] singular value at which both kinds of rows have equal say
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, options);
    const double length = row_length(jet, options);
    const TangentialRows<2> curvature = curvature_rows(jet, basis, v_n, length),
                            total = total_rows(jet, basis, v_n, length);
    const Vec2 by_curvature = solve_damped(curvature, options.damping).y,
               by_total = solve_damped(total, options.damping).y;
    const auto [Q, V] = orthogonal_columns(curvature.R);
    Vec2 y = by_total;
    for (int k = 0; k < 2; ++k) {
      const double share = std::pow(confidence(Q.col(k).norm(), kUndetermined * options.damping), 2);
      y += share * V.col(k).dot(by_curvature - by_total) * V.col(k);
    }
    return PointVelocity{v_n + limited(basis * y, options.speed_limit * jet.fastest_in_reach),
                         solve_damped(stacked(total, curvature), options.damping).confidence};
  });
}

}  // namespace kappaflow
