// A ball of a hundred thousand particles falls on stairs: pieces come off, and cells of the preconditioner
// hold one particle beside others of thousands.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

TEST(Landing, OfALargeBallTakesFewIterations) {
  FluidOptions o;
  o.spacing = 0.0087;
  o.kinematic_viscosity = 5;
  auto points = test::blob(0.25, o.spacing);
  for (Vec3& x : points) x += Vec3(-0.05, 1.06, 0);
  ASSERT_GT(points.size(), 90000u);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3(1.2, -3, 0)),
                     solid_walls(test::stairs(4, 0.2, 0.5, 1.6)));
  const double duration = 0.3, landed = 0.1;
  int steps = 0, iterations = 0;
  while (solver.time() < duration) {
    const FluidStep step = solver.step(duration - solver.time());
    ASSERT_LE(step.viscosity_error, 1) << solver.time();
    ASSERT_LT(step.density_error_mean, 5e-4) << solver.time();
    if (solver.time() < landed) continue;
    ++steps;
    iterations += step.viscosity_iterations;
  }
  EXPECT_LE(iterations, 12 * steps);
  const Particles p = solver.particles();
  EXPECT_TRUE(std::ranges::any_of(p.position, [](const Vec3& x) { return x.y() < 0.7; }))
      << "it never landed";
}

}  // namespace
}  // namespace kappaflow
