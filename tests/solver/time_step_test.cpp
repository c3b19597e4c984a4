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

}  // namespace
}  // namespace kappaflow
