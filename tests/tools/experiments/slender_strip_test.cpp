// The folding of slender strips against its limits, which need no program.
#include "tools/experiments/slender_strip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.h"

namespace kappaflow {
namespace {

// Where viscosity alone acts, neither it nor the thickness matters: liquid that is fed faster than it sinks
// has to fold, and the frequency is a number times speed over height.
TEST(SlenderStrip, FoldsByItsGeometryAloneWithoutGravity) {
  const double number = folding_frequency({10, 0, 0.1, 0.002, 0.004, 0.04}) * 0.04 / 0.1;
  EXPECT_NEAR(number, 4.9, 0.2);
  EXPECT_NEAR(folding_frequency({40, 0, 0.1, 0.002, 0.004, 0.04}) * 0.04 / 0.1, number, 0.01 * number);
  EXPECT_NEAR(folding_frequency({10, 0, 0.1, 0.001, 0.004, 0.04}) * 0.04 / 0.1, number, 0.05 * number);
  EXPECT_NEAR(folding_frequency({10, 0, 0.2, 0.004, 0.004, 0.08}) * 0.08 / 0.2, number, 0.01 * number);
}

// Where its weight bends it, over a length that is short against the height, the moments 3 nu I W / length^2
// and g A length^2 with length W = speed are alike: W = c (g speed^3 / (nu thickness^2))^(1/4), with a
// number c of about 1, whatever the height.
TEST(SlenderStrip, FoldsByItsWeight) {
  const auto number = [](double gravity, double thickness, double height) {
    const double frequency = folding_frequency({10, gravity, 0.1, thickness, thickness, height});
    return frequency / std::pow(gravity * 1e-3 / (10 * thickness * thickness), 0.25);
  };
  for (const double height : {0.09, 0.1, 0.11}) EXPECT_NEAR(number(50, 0.001, height), 1, 0.15) << height;
  EXPECT_NEAR(number(100, 0.001, 0.1), 1, 0.15);
  EXPECT_NEAR(number(100, 0.0014, 0.1), 1, 0.15);
}

// It says so where a strip spreads or falls without folding.
TEST(SlenderStrip, SaysWhenItDoesNotFold) {
  EXPECT_THROW(folding_frequency({1, 0, 0.1, 0.04, 0.04, 0.01}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
