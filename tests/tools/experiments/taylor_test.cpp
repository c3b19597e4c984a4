#include "tools/experiments/taylor.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

const Vec3 kPlace(0.7, -1.3, 0.4);

template <int Degree>
std::array<Taylor<Degree>, 3> variables() {
  return {Taylor<Degree>::variable(kPlace[0], 0), Taylor<Degree>::variable(kPlace[1], 1),
          Taylor<Degree>::variable(kPlace[2], 2)};
}

/// The ten in their order.
std::array<double, 10> listed(const ThirdDerivatives& C) {
  return {C.xxx, C.xxy, C.xxz, C.xyy, C.xyz, C.xzz, C.yyy, C.yyz, C.yzz, C.zzz};
}

// (x + 2y + 3z)^3: the derivative along axes a, b, c is 6 k_a k_b k_c with k = (1, 2, 3).
TEST(Taylor, HasTheDerivativesOfACube) {
  const auto [x, y, z] = variables<3>();
  const Vec3 k(1, 2, 3);
  const double l0 = k.dot(kPlace);
  const Taylor<3> l = x + 2 * y + 3 * z, cube = l * l * l;
  EXPECT_NEAR(cube.value(), l0 * l0 * l0, 1e-14);
  EXPECT_LT((cube.gradient() - 3 * l0 * l0 * k).norm(), 1e-14);
  EXPECT_LT((cube.hessian() - 6 * l0 * k * k.transpose()).norm(), 1e-13);
  const std::array<double, 10> expected{6, 12, 18, 24, 36, 54, 48, 72, 108, 162};
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(listed(cube.third_derivatives())[i], expected[i], 1e-12) << i;
}

// sin(x y) z, whose derivatives are written out by hand.
TEST(Taylor, HasTheDerivativesOfASine) {
  const auto [x, y, z] = variables<3>();
  const Taylor<3> f = sine_and_cosine(x * y).first * z;
  const double X = kPlace[0], Y = kPlace[1], Z = kPlace[2], s = std::sin(X * Y), c = std::cos(X * Y);
  EXPECT_NEAR(f.value(), s * Z, 1e-15);
  EXPECT_LT((f.gradient() - Vec3(Y * Z * c, X * Z * c, s)).norm(), 1e-14);
  Mat3 A;
  A << -Y * Y * Z * s, Z * (c - X * Y * s), Y * c, Z * (c - X * Y * s), -X * X * Z * s, X * c, Y * c, X * c,
      0;
  EXPECT_LT((f.hessian() - A).norm(), 1e-14);
  const std::array<double, 10> C{-Y * Y * Y * Z * c,
                                 -Z * (2 * Y * s + X * Y * Y * c),
                                 -Y * Y * s,
                                 -Z * (2 * X * s + X * X * Y * c),
                                 c - X * Y * s,
                                 0,
                                 -X * X * X * Z * c,
                                 -X * X * s,
                                 0,
                                 0};
  for (int i = 0; i < 10; ++i) EXPECT_NEAR(listed(f.third_derivatives())[i], C[i], 1e-14) << i;
}

TEST(Taylor, SquaresOfSineAndCosineAddUpToOne) {
  const auto [x, y, z] = variables<3>();
  const auto [s, c] = sine_and_cosine(x * y * z + 2 * x - z);
  const Taylor<3> one = s * s + c * c;
  EXPECT_NEAR(one.value(), 1, 1e-15);
  EXPECT_LT(one.gradient().norm() + one.hessian().norm(), 1e-13);
  for (const double third : listed(one.third_derivatives())) EXPECT_NEAR(third, 0, 1e-12);
}

TEST(Taylor, LowerDegreesAreTheSameFunction) {
  const auto f = [](const auto& p) { return sine_and_cosine(p[0] * p[1] - 3 * p[2]).second * p[0]; };
  const Taylor<3> third = f(variables<3>());
  const Taylor<2> second = f(variables<2>());
  const Taylor<1> first = f(variables<1>());
  EXPECT_LT((third.hessian() - second.hessian()).norm(), 1e-14);
  EXPECT_LT((third.gradient() - first.gradient()).norm(), 1e-14);
  EXPECT_NEAR(third.value(), f(std::array<double, 3>{kPlace[0], kPlace[1], kPlace[2]}), 1e-15);
}

TEST(Taylor, DerivativeShiftsTheCoefficients) {
  const auto [x, y, z] = variables<3>();
  const Taylor<3> f = sine_and_cosine(x * y - z).first * x;
  for (int axis = 0; axis < 3; ++axis) {
    const Taylor<2> d = f.derivative(axis);
    EXPECT_NEAR(d.value(), f.gradient()[axis], 1e-15);
    EXPECT_LT((d.gradient() - f.hessian().col(axis)).norm(), 1e-15);
    EXPECT_LT((d.hessian() - f.third_derivatives().contract(Vec3::Unit(axis))).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace kappaflow
