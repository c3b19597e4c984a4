#include "solver/kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kappaflow {
namespace {

constexpr float kSupport = 0.08f;

TEST(CubicSpline, IntegratesToOne) {
  const CubicSpline kernel(kSupport);
  const int steps = 4000;
  const double dr = static_cast<double>(kSupport) / steps;
  double integral = 0;
  for (int k = 0; k < steps; ++k) {
    const double r = (k + 0.5) * dr;
    integral += 4 * std::numbers::pi * r * r * static_cast<double>(kernel.value(static_cast<float>(r))) * dr;
  }
  EXPECT_NEAR(integral, 1, 1e-5);
}

TEST(CubicSpline, IsMonaghansPolynomial) {
  const CubicSpline kernel(kSupport);
  const double sigma = 8 / (std::numbers::pi * std::pow(static_cast<double>(kSupport), 3));
  for (double q = 0; q < 1.2; q += 0.01) {
    const double expected = q < 0.5 ? 6 * (q * q * q - q * q) + 1 : q < 1 ? 2 * std::pow(1 - q, 3) : 0;
    EXPECT_NEAR(static_cast<double>(kernel.value(static_cast<float>(q) * kSupport)), sigma * expected,
                1e-5 * sigma);
  }
}

TEST(CubicSpline, GradientMatchesFiniteDifferences) {
  const CubicSpline kernel(kSupport);
  const float step = 1e-3f * kSupport;
  const double scale = static_cast<double>(kernel.value(0) / kSupport);
  for (float r = 0.02f * kSupport; r < 1.1f * kSupport; r += 0.013f * kSupport) {
    const double expected =
        static_cast<double>((kernel.value(r + step) - kernel.value(r - step)) / (2 * step));
    EXPECT_NEAR(static_cast<double>(kernel.gradient_factor(r) * r), expected, 1e-3 * scale) << r;
    EXPECT_LE(kernel.gradient_factor(r), 0);
  }
}

TEST(CubicSpline, StaysFiniteAtTheCentre) {
  const CubicSpline kernel(kSupport);
  EXPECT_TRUE(std::isfinite(kernel.gradient_factor(0)));
  EXPECT_EQ(kernel.gradient_factor(0) * 0, 0);
}

TEST(CubicSpline, MakesACubicLatticeDenseAsRest) {
  const CubicSpline kernel(2);
  double sum = 0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k)
        sum += static_cast<double>(kernel.value(std::sqrt(static_cast<float>(i * i + j * j + k * k))));
  EXPECT_NEAR(sum, 1, 1e-4);
}

}  // namespace
}  // namespace kappaflow
