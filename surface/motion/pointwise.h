// What the pointwise velocity methods share: a tangent basis, the loop over the batch, and the sum of normal
// and tangential velocity.
#pragma once

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "surface/motion/tangential_rows.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

/// The velocity at one point [m/s] and how well its tangential part is determined, in [0, 1].
struct PointVelocity {
  Vec3 velocity = Vec3::Zero();
  double confidence = 0;
};

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

/// Calls point_velocity(x, jet) -> PointVelocity at every point where the field has a gradient; zero
/// elsewhere.
template <class Evaluate>
void evaluate_pointwise(const Field& field, const SurfacePoints& points, SurfaceVelocities& result,
                        const Evaluate& point_velocity) {
  const std::size_t n = points.position.size();
  result.velocity.resize(n);
  result.confidence.resize(n);
  constexpr std::size_t kPointsPerTask = 64;
  parallel_for(
      n,
      [&](std::size_t i) {
        const Jet jet = field.jet(points.position[i]);
        const PointVelocity at_point =
            has_gradient(jet) ? point_velocity(points.position[i], jet) : PointVelocity{};
        result.velocity[i] = at_point.velocity;
        result.confidence[i] = at_point.confidence;
      },
      kPointsPerTask);
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
