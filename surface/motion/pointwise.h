// What the pointwise velocity methods share: a tangent basis, rows of linear equations for the tangential
// velocity, their damped least-squares solution, and the loop over the batch.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
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

/// Equations R y = b for the tangential velocity v_t = E y: R is dimensionless, b in m/s.
template <int Rows>
struct TangentialRows {
  Eigen::Matrix<double, Rows, 2> R;
  Eigen::Matrix<double, Rows, 1> b;
};

/// The rows of both.
template <int M, int N>
TangentialRows<M + N> stacked(const TangentialRows<M>& first, const TangentialRows<N>& second) {
  TangentialRows<M + N> both;
  both.R << first.R, second.R;
  both.b << first.b, second.b;
  return both;
}

/// s/sqrt(s^2 + lambda^2) in [0, 1]: how well a direction with the singular value s of the dimensionless rows
/// is determined.
inline double confidence(double s, double lambda) {
  const double sum = s * s + lambda * lambda;
  return sum > 0 ? std::sqrt(s * s / sum) : 0;
}

/// R = Q V^T with orthonormal V and orthogonal columns of Q, whose lengths are the singular values of R.
template <int Rows>
struct OrthogonalColumns {
  Eigen::Matrix<double, Rows, 2> Q;
  Eigen::Matrix2d V;
};

/// In closed form: one Jacobi rotation (Hestenes 1958). R^T R is not formed, so a small singular value keeps
/// its digits.
template <int Rows>
OrthogonalColumns<Rows> orthogonal_columns(const Eigen::Matrix<double, Rows, 2>& R) {
  const double a = R.col(0).squaredNorm(), c = R.col(1).squaredNorm(), ac = R.col(0).dot(R.col(1));
  const double zeta = 0.5 * (c - a);
  const double length = std::hypot(zeta, ac);
  const double tangent = ac == 0 ? 0 : (zeta >= 0 ? ac / (zeta + length) : ac / (zeta - length));
  const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = cosine * tangent;
  OrthogonalColumns<Rows> result;
  result.V << cosine, sine, -sine, cosine;
  result.Q = R * result.V;
  return result;
}

/// The minimum y of |R y - b|^2 + lambda^2 |y|^2 and the confidence of the smaller singular value of R.
struct DampedSolution {
  Vec2 y;
  double confidence;
};

/// Without damping, a direction that R says nothing about gets no velocity.
template <int Rows>
DampedSolution solve_damped(const TangentialRows<Rows>& rows, double lambda) {
  const auto [Q, V] = orthogonal_columns(rows.R);
  const auto damped = [lambda](double s2, double projection) {
    const double sum = s2 + lambda * lambda;
    return sum > 0 ? projection / sum : 0;
  };
  const double s0 = Q.col(0).squaredNorm(), s1 = Q.col(1).squaredNorm();
  const Vec2 in_v(damped(s0, Q.col(0).dot(rows.b)), damped(s1, Q.col(1).dot(rows.b)));
  return {V * in_v, confidence(std::sqrt(std::min(s0, s1)), lambda)};
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

/// Normal velocity plus the damped, limited solution of the tangential rows in the given basis.
template <int Rows>
PointVelocity with_tangential(const Vec3& normal_velocity, const TangentBasis& basis,
                              const TangentialRows<Rows>& rows, const Field& field,
                              const VelocityOptions& options) {
  const DampedSolution solution = solve_damped(rows, options.damping);
  const Vec3 tangential = basis * solution.y;
  return {normal_velocity + limited(tangential, options.speed_limit * field.fastest_speed()),
          solution.confidence};
}

}  // namespace kappaflow
