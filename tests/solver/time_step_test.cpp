#include "solver/time_step.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kappaflow {
namespace {

TEST(TimeStep, CflStepMovesExactlyTheDistance) {
  for (const double speed : {0.0, 0.1, 3.0, 100.0}) {
    const double dt = cfl_time_step(speed, 9.81, 0.016);
    EXPECT_NEAR((speed + 9.81 * dt) * dt, 0.016, 1e-12);
  }
  EXPECT_NEAR(cfl_time_step(2, 0, 0.016), 0.008, 1e-15);
  EXPECT_TRUE(std::isinf(cfl_time_step(0, 0, 0.016)));
}

TEST(TimeStep, NeverLeavesASliver) {
  for (const double left : {0.001, 0.003, 0.00300001, 0.0045, 0.0059999, 0.006, 0.02, 1.0}) {
    double remaining = left;
    int steps = 0;
    while (remaining > 0) {
      const double dt = fit_time_step(0.003, remaining);
      EXPECT_LE(dt, 0.003);
      EXPECT_GE(dt, std::min(0.0015, left)) << left;
      remaining -= dt;
      ASSERT_LT(++steps, 1000);
    }
    EXPECT_EQ(remaining, 0);
  }
}

TEST(TimeStep, StepsToAFrameAreEqualAndNoMoreThanNeeded) {
  int steps = 0;
  double time = 0;
  for (int frame = 1; frame <= 50; ++frame)
    for (const double end = 0.04 * frame, first = fit_time_step(0.005, end - time); end - time > 1e-12;) {
      const double dt = fit_time_step(0.005, end - time);
      EXPECT_NEAR(dt, first, 1e-12);
      time += dt;
      ++steps;
    }
  EXPECT_EQ(steps, 50 * 8);
  EXPECT_NEAR(fit_time_step(0.005, 0.041), 0.041 / 9, 1e-15);
  EXPECT_EQ(fit_time_step(0.005, INFINITY), 0.005);
}

}  // namespace
}  // namespace kappaflow
