// The coiling of slender threads against another program's solution of the same equations (collocation of
// fourth order on a mesh of its own), and its limits.
#include "tools/experiments/slender_thread.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.h"

namespace kappaflow {
namespace {

TEST(SlenderThread, CoilsAsAnotherSolverSays) {
  struct Expected {
    FallingThread thread;
    double frequency, radii;  // of the coil, in radii of the thread there
  };
  for (const auto& [thread, frequency, radii] :
       {Expected{{0.1, 1, 0.1, 0.00407, 0.048}, 7.77545, 2.76607},
        Expected{{0.1, 1, 0.1, 0.00407, 0.04}, 8.95969, 2.20882},
        Expected{{0.05, 9.81, 0.1, 0.00407, 0.048}, 13.76296, 2.42781}}) {
    const SteadyCoil coil = steady_coil(thread);
    EXPECT_NEAR(coil.frequency, frequency, 1e-3 * frequency);
    EXPECT_NEAR(coil.radius / coil.thread_radius, radii, 2e-3 * radii);
  }
}

// Where nothing but viscosity acts the frequency is a number times speed over height, whatever the viscosity;
// and the thread is laid down as fast as it arrives.
TEST(SlenderThread, ViscousCoilingGoesWithSpeedOverHeight) {
  const SteadyCoil one = steady_coil({1e8, 0, 1, 0.05, 1}), other = steady_coil({1e7, 0, 3, 0.1, 2});
  EXPECT_NEAR(one.frequency, 3.9002, 4e-3);
  EXPECT_NEAR(other.frequency, 1.5 * one.frequency, 1e-3);
  const double speed = std::pow(0.05 / one.thread_radius, 2);
  EXPECT_NEAR(one.frequency * one.radius, speed, 1e-6);
}

TEST(SlenderThread, SaysWhereItFindsNoSolution) {
  EXPECT_THROW(steady_coil({1e-4, 9.81, 0.1, 0.001, 0.3}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
