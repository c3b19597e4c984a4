// What methods share that solve for the tangential velocity at a point: a tangent basis, and the sum of
// normal and tangential velocity.
#pragma once

#include <Eigen/Geometry>

#include "surface/motion/pointwise.h"
#include "surface/motion/tangential_rows.h"

namespace kappaflow {

/// Two orthonormal columns that span the tangent plane.
using TangentBasis = Eigen::Matrix<double, 3, 2>;

/// A tangent basis for the unit normal n. No method's result depends on which one it is.
inline TangentBasis tangent_basis(const Vec3& n) {
  int smallest = 0;
  n.cwiseAbs().minCoeff(&smallest);
  TangentBasis basis;
  basis.col(0) = n.cross(Vec3::Unit(smallest)).normalized();
  basis.col(1) = n.cross(basis.col(0));
  return basis;
}

/// The length L of total_rows() and curvature_rows() [m].
inline double row_length(const Jet& jet, const VelocityOptions& options) {
  return options.row_scale == RowScale::sigma ? jet.length_scale : 1;
}

/// Normal velocity plus the damped, limited solution of the tangential rows of a jet in the given basis.
template <int Rows>
PointVelocity with_tangential(const Vec3& normal_velocity, const TangentBasis& basis,
                              const TangentialRows<Rows>& rows, const Jet& jet,
                              const VelocityOptions& options) {
  const double fastest = jet.fastest_in_reach;
  const DampedSolution solution = solve_damped(rows, options.damping);
  const Vec3 tangential = basis * solution.y;
  return {normal_velocity + limited(tangential, options.speed_limit * fastest), solution.confidence};
}

}  // namespace kappaflow
