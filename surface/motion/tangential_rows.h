// Rows of linear equations for the tangential velocity, and their damped least-squares solution: in closed
// form, or with the minimisers that Fujisawa et al. 2011 name.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/types.h"
#include "surface/motion/minimisers.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

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
  const double length = std::sqrt(zeta * zeta + ac * ac);  // rows of order 1: hypot's care would cost more
                                                           // than all the rest
  const double tangent = length == 0 ? 0 : ac / (zeta + std::copysign(length, zeta));
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

/// The damped sum of squares and its gradient, in units of a speed: z = y / scale.
template <int Rows>
struct DampedSum {
  double operator()(const Vec2& z) const {
    return (rows.R * z - b).squaredNorm() + lambda * lambda * z.squaredNorm();
  }
  double operator()(const Vec2& z, Vec2& gradient) const {
    gradient = 2 * (rows.R.transpose() * (rows.R * z - b) + lambda * lambda * z);
    return (*this)(z);
  }

  const TangentialRows<Rows>& rows;
  Eigen::Matrix<double, Rows, 1> b;  // rows.b / scale
  double lambda;
};

/// The minimum of |R y - b|^2 + lambda^2 |y|^2.
struct TangentialMinimum {
  Vec2 y;             ///< [m/s]
  double confidence;  ///< of solve_damped(), however y was found
  int evaluations;    ///< of the sum; 1 for the closed form
};

/// Finds it from y = 0 by the chosen minimiser. scale: a speed that y is measured in, so that the minimiser's
/// tolerances are dimensionless [m/s]; where it is 0 nothing moves, and any will do.
template <int Rows>
TangentialMinimum minimise(const TangentialRows<Rows>& rows, double lambda, double scale,
                           Minimiser minimiser) {
  const DampedSolution closed = solve_damped(rows, lambda);
  if (minimiser == Minimiser::closed_form) return {closed.y, closed.confidence, 1};
  const double unit = scale > 0 ? scale : 1;
  const DampedSum<Rows> sum{rows, rows.b / unit, lambda};
  const Vec2 start = Vec2::Zero();
  const Minimum<2> minimum =
      minimiser == Minimiser::bfgs ? minimise_bfgs<2>(sum, start) : minimise_powell<2>(sum, start);
  return {unit * minimum.x, closed.confidence, minimum.evaluations};
}

}  // namespace kappaflow
