#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "surface/motion/tangential.h"
#include "tests/surface/motion/tangential_problems.h"

namespace kappaflow {
namespace {

using testing::objective;
using testing::rows_with_singular_values;

/// The same problem as an ordinary least-squares problem, R over lambda I, by pivoted QR.
Vec2 dense_solution(const TangentialRows<4>& rows, double lambda) {
  Eigen::Matrix<double, 6, 2> A;
  A << rows.R, lambda * Eigen::Matrix2d::Identity();
  Eigen::Matrix<double, 6, 1> b;
  b << rows.b, 0, 0;
  return testing::least_squares(A, b);
}

TEST(DampedLeastSquares, AgreesWithDenseQrAndSingularValues) {
  std::mt19937 random(1);
  for (const double s1 : {1.0, 1e-2, 1e-4, 1e-6, 0.0})
    for (const double lambda : {1.0, 0.1, 1e-3, 1e-6})
      for (int i = 0; i < 20; ++i) {
        const TangentialRows<4> rows = rows_with_singular_values(random, 3.0, s1);
        const DampedSolution solution = solve_damped(rows, lambda);
        const Vec2 expected = dense_solution(rows, lambda);
        // Rounding of size eps |R| moves a solution y with residual r by up to eps |R| (|y|/s + |r|/s^2).
        const double s = std::hypot(s1, lambda);
        EXPECT_LT((solution.y - expected).norm(), 1e-14 / s * (expected.norm() + rows.b.norm() / s));
        EXPECT_NEAR(solution.confidence, s1 / std::hypot(s1, lambda), 1e-14 / lambda);
      }
}

TEST(DampedLeastSquares, NoStepInAnyDirectionLowersTheSum) {
  std::mt19937 random(2);
  for (int i = 0; i < 50; ++i) {
    const TangentialRows<4> rows = rows_with_singular_values(random, 2.0, 0.3);
    const Vec2 y = solve_damped(rows, 0.1).y;
    const double least = objective(rows, 0.1, y);
    for (const double step : {1e-1, 1e-3, 1e-5})
      for (int k = 0; k < 16; ++k) {
        const double angle = 2 * std::numbers::pi * k / 16;
        EXPECT_GT(objective(rows, 0.1, y + step * Vec2(std::cos(angle), std::sin(angle))), least);
      }
  }
}

TEST(DampedLeastSquares, KeepsTheDigitsOfASmallSingularValue) {
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const TangentialRows<4> rows = rows_with_singular_values(random, 1.0, 1e-9);
    EXPECT_NEAR(solve_damped(rows, 1e-9).confidence, std::sqrt(0.5),
                1e-6);  // R^T R would have lost it: 1e-18
  }
}

TEST(DampedLeastSquares, WithoutDampingAnUndeterminedDirectionStaysAtRest) {
  TangentialRows<2> rows;
  rows.R << 3, 4, 0, 0;
  rows.b << 10, 7;
  const DampedSolution one_row = solve_damped(rows, 0);
  EXPECT_LT((one_row.y - Vec2(1.2, 1.6)).norm(), 1e-15);  // the shortest solution of 3 a + 4 b = 10
  EXPECT_EQ(one_row.confidence, 0);
  rows.R.setZero();
  EXPECT_EQ(solve_damped(rows, 0).y, Vec2(0, 0));
  EXPECT_EQ(solve_damped(rows, 0.1).confidence, 0);
}

TEST(TangentBasis, IsOrthonormalAndTangential) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Vec3 n =
        i < 3 ? Vec3(Vec3::Unit(i)) : Vec3(normal(random), normal(random), normal(random)).normalized();
    const TangentBasis E = tangent_basis(n);
    EXPECT_LT((E.transpose() * E - Eigen::Matrix2d::Identity()).norm(), 1e-15);
    EXPECT_LT((E.transpose() * n).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace kappaflow
