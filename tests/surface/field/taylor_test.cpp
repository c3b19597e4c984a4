#include "surface/field/taylor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kappaflow {
namespace {

const Vec3 kPlace(0.7, -1.3, 0.4);

template <int Degree>
auto variables() {
  return taylor_variables<Degree>(kPlace);
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

/// The differences of value and derivatives, summed up.
double distance(const Taylor<3>& a, const Taylor<3>& b) {
  const Taylor<3> d = a - b;
  double sum = std::abs(d.value()) + d.gradient().norm() + d.hessian().norm();
  for (const double third : listed(d.third_derivatives())) sum += std::abs(third);
  return sum;
}

TEST(Taylor, RootsExponentialsAndQuotientsUndoWhatTheyDo) {
  const auto [x, y, z] = variables<3>();
  const Taylor<3> a = x * x + y * y + x * z + 3, b = x * y - z;
  EXPECT_LT(distance(sqrt(a) * sqrt(a), a), 1e-14);
  EXPECT_LT(distance(a / b * b, a), 1e-11);
  EXPECT_LT(distance(3 / a * a, x - x + 3), 1e-12);
  EXPECT_LT(distance(a / 4, 0.25 * a), 1e-15);
  Taylor<3> c = a;
  c -= b;
  EXPECT_LT(distance(c, a - b), 1e-15);
  EXPECT_LT(distance(exp(a) * exp(-a), x - x + 1), 1e-10);
  EXPECT_LT(distance(exp(a + b), exp(a) * exp(b)), 1e-12 * exp(a + b).value());
  // The derivative of exp(b) is exp(b) b', of sqrt(a) it is a'/(2 sqrt a).
  EXPECT_LT((exp(b).gradient() - exp(b).value() * b.gradient()).norm(), 1e-14);
  EXPECT_LT((sqrt(a).gradient() - a.gradient() / (2 * std::sqrt(a.value()))).norm(), 1e-14);
}

// The distance from a point has no gradient there, but a value.
TEST(Taylor, ValuesStandWhereDerivativesDoNot) {
  const auto [x, y, z] = taylor_variables<3>(Vec3::Zero());
  EXPECT_EQ((1 - sqrt(x * x + y * y + z * z)).value(), 1);
}

TEST(Taylor, MakesAJet) {
  const auto f = [](const auto& p) { return exp(p[0] * p[1]) - p[2] * p[2]; };
  const auto rate = [](const auto& p) { return p[0] * p[2]; };
  const Jet jet = jet_of(f(taylor_variables<3>(kPlace)), rate(taylor_variables<2>(kPlace)), 0.5, 2);
  const double e = std::exp(kPlace[0] * kPlace[1]);
  EXPECT_NEAR(jet.f, e - kPlace[2] * kPlace[2], 1e-15);
  EXPECT_LT((jet.g - Vec3(kPlace[1] * e, kPlace[0] * e, -2 * kPlace[2])).norm(), 1e-15);
  EXPECT_NEAR(jet.A(2, 2), -2, 1e-15);
  EXPECT_NEAR(jet.C.xxx, std::pow(kPlace[1], 3) * e, 1e-14);
  EXPECT_NEAR(jet.f_t, kPlace[0] * kPlace[2], 1e-15);
  EXPECT_LT((jet.g_t - Vec3(kPlace[2], 0, kPlace[0])).norm(), 1e-15);
  EXPECT_EQ(jet.A_t(0, 2), 1);
  EXPECT_EQ(jet.length_scale, 0.5);
  EXPECT_EQ(jet.fastest_in_reach, 2);
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
