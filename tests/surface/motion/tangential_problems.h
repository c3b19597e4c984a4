// Least-squares problems for the tangential velocity, with known singular values.
#pragma once

#include <random>

#include "surface/motion/tangential_rows.h"
#include "tests/dense.h"

namespace kappaflow::testing {

/// Rows with the given singular values in random directions, and a random right-hand side of size 1.
inline TangentialRows<4> rows_with_singular_values(std::mt19937& random, double s0, double s1) {
  std::normal_distribution<double> normal;
  const Eigen::Matrix4d left = random_orthogonal(random, 4);
  const Eigen::Matrix2d right = random_orthogonal(random, 2);
  TangentialRows<4> rows;
  rows.R = left.leftCols<2>() * Vec2(s0, s1).asDiagonal() * right;
  rows.b = Eigen::Vector4d::NullaryExpr([&] { return normal(random); });
  return rows;
}

inline double objective(const TangentialRows<4>& rows, double lambda, const Vec2& y) {
  return (rows.R * y - rows.b).squaredNorm() + lambda * lambda * y.squaredNorm();
}

}  // namespace kappaflow::testing
