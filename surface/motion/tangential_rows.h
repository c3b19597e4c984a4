// Rows of linear equations for the tangential velocity, and their damped least-squares solution in closed
// form. Fujisawa et al. 2011 look for the same minimum by iteration: tools/experiments/tangential_minimum.h.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/types.h"

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

}  // namespace kappaflow
