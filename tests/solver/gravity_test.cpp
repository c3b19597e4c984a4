// Gravity that changes in time.
#include <gtest/gtest.h>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1;

FluidOptions options() {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 0.1;
  o.max_time_step = 1e-3;
  return o;
}

// g = (0, -10, 0) until 0.1 s, changes to (6, 4, 0) until 0.3 s and stays: the integrals by hand.
TEST(GravityInTime, FreeFallIsTheAnalyticOne) {
  FluidOptions o = options();
  const Vec3 a(0, -10, 0), b(6, 4, 0), v0(1, 2, 3);
  o.gravity_table.keys = {{0.1, a}, {0.3, b}};
  const std::vector<Vec3> start = test::block(Vec3::Zero(), Vec3::Constant(0.3), kSpacing);
  FluidSolver s(o, start, std::vector<Vec3>(start.size(), v0), {});
  while (s.time() < 0.5) s.step(0.5 - s.time());
  const Vec3 slope = (b - a) / 0.2;
  const Vec3 v1 = v0 + 0.1 * a, x1 = 0.1 * v0 + 0.005 * a;
  const Vec3 v2 = v1 + 0.2 * a + 0.02 * slope, x2 = x1 + 0.2 * v1 + 0.02 * a + 0.008 / 6 * slope;
  const Vec3 v3 = v2 + 0.2 * b, x3 = x2 + 0.2 * v2 + 0.02 * b;
  const Particles p = s.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LT((p.velocity[i] - v3).norm(), 1e-4);
    EXPECT_LT((p.position[i] - start[i] - x3).norm(), 0.5 * o.max_time_step * (v3 - v0).norm() + 1e-4);
  }
}

/// A basin's corner with liquid in it.
std::vector<Vec3> positions_in_tank(const FluidOptions& o) {
  const double wall = 2 * kSpacing;
  const std::vector<SolidWall> walls{SolidWall(test::box_surface(Vec3(-wall, -wall, -wall), Vec3(1, 0, 1))),
                                     SolidWall(test::box_surface(Vec3(-wall, 0, -wall), Vec3(0, 1, 1)))};
  const std::vector<Vec3> start = test::block(Vec3::Zero(), Vec3(0.5, 0.4, 0.5), kSpacing);
  FluidSolver s(o, start, std::vector<Vec3>(start.size(), Vec3::Zero()), walls);
  for (int k = 0; k < 30; ++k) s.step(1);
  return s.particles().position;
}

TEST(GravityInTime, ConstantTableIsConstantGravityBitForBit) {
  FluidOptions o = options();
  o.max_time_step = 5e-3;
  o.gravity = Vec3(-3.1, -9.17, 0.3);
  const std::vector<Vec3> constant = positions_in_tank(o);
  FluidOptions table = o;
  table.gravity_table.keys = {{0, o.gravity}, {0.013, o.gravity}, {0.05, o.gravity}};
  EXPECT_EQ(positions_in_tank(table), constant);
  table.gravity_table.keys[1].value.x() = 0;
  EXPECT_NE(positions_in_tank(table), constant);
}

TEST(GravityInTime, MistakesAreRefused) {
  const std::vector<Vec3> one{Vec3::Zero()};
  FluidOptions o = options();
  o.gravity_table.keys = {{0, Vec3::Zero()}, {0, Vec3::Zero()}};
  EXPECT_THROW(FluidSolver(o, one, one, {}), InvalidInput);
  o.gravity_table.keys = {{0, Vec3(std::nan(""), 0, 0)}};
  EXPECT_THROW(FluidSolver(o, one, one, {}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
