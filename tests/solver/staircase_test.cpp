// The scene that the solver is for: viscous liquid slides down stairs. Every step must keep its promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

struct Case {
  double spacing, viscosity, duration;
  double max_compression;  // of any particle in any step
};

class Staircase : public testing::TestWithParam<Case> {};

TEST_P(Staircase, KeepsDensityAndWalls) {
  const Case c = GetParam();
  FluidOptions o;
  o.spacing = c.spacing;
  o.kinematic_viscosity = c.viscosity;
  const auto walls = solid_walls(test::stairs(4, 0.2, 0.5, 1.6));
  const auto points = test::block({-0.9, 0.8, -0.48}, {-0.1, 1.44, 0.48}, c.spacing);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3(1.2, 0, 0)), walls);
  double deepest = 0;
  while (solver.time() < c.duration) {
    const FluidStep step = solver.step(c.duration - solver.time());
    ASSERT_LT(step.density_error_mean, 5e-4) << "at " << solver.time();
    ASSERT_LT(step.density_error_max, c.max_compression) << "at " << solver.time();
    // Nothing gains more than free fall from where it started gives.
    ASSERT_LT(step.fastest, 1.2 + 9.81 * solver.time() + 0.5) << "at " << solver.time();
    for (const Vec3& x : solver.particles().position)
      deepest = std::max(deepest, -nearest_of_walls(walls, x).distance / c.spacing);
    ASSERT_LT(deepest, 0.6) << "at " << solver.time();
  }
  const Particles p = solver.particles();
  EXPECT_TRUE(std::any_of(p.position.begin(), p.position.end(), [](const Vec3& x) { return x.x() > 0.1; }))
      << "the liquid never left the landing";
}

// The density at the end of a step is predicted to first order; what is of second order where liquid hits an
// edge, a handful of particles, is moved apart.
INSTANTIATE_TEST_SUITE_P(, Staircase, testing::Values(KAPPAFLOW_STAIRCASES));

}  // namespace
}  // namespace kappaflow
