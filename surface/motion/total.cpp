#include "surface/motion/total.h"

#include "surface/motion/normal.h"

namespace kappaflow {

TangentialRows<2> total_rows(const Jet& jet, const TangentBasis& basis, const Vec3& normal_velocity,
                             double length) {
  const double scale = length / jet.g.norm();
  const Eigen::Matrix<double, 2, 3> projected = basis.transpose() * jet.A;
  return {scale * projected * basis, -scale * (projected * normal_velocity + basis.transpose() * jet.g_t)};
}

void evaluate_total(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                    VelocitySpans result) {
  evaluate_pointwise(field, points, options, result, [&](const Vec3& /*x*/, const Jet& jet) {
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, options);
    return with_tangential(v_n, basis, total_rows(jet, basis, v_n, row_length(jet, options)), jet, options);
  });
}

}  // namespace kappaflow
