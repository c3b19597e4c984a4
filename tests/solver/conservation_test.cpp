// What liquid keeps, or does not exceed: the validations of drop, basin and falling liquid at small size.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

struct Momenta {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double speeds = 0, moments = 0;  // sums of lengths
};

Momenta momenta(const Particles& p) {
  Momenta m;
  for (std::size_t i = 0; i < p.size(); ++i) {
    m.linear += p.velocity[i];
    m.angular += p.position[i].cross(p.velocity[i]);
    m.speeds += p.velocity[i].norm();
    m.moments += p.position[i].norm() * p.velocity[i].norm();
  }
  return m;
}

// Single precision rounds by 6e-8; a thousand steps all to one side would add up to 6e-5.
TEST(Conservation, SpinningDropKeepsItsMomentum) {
  FluidOptions o;
  o.spacing = 0.01;
  o.kinematic_viscosity = 1e-3;
  o.surface_tension = 1;
  o.gravity.setZero();
  const std::vector<Vec3> points = test::blob(0.045, o.spacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.push_back(Vec3(0.1, 0.05, 0) + Vec3(0, 0, 2.5).cross(x));
  FluidSolver solver(o, points, velocity, {});
  const Momenta before = momenta(solver.particles());
  for (int k = 0; k < 1000; ++k) solver.step(1e3);
  const Momenta after = momenta(solver.particles());
  EXPECT_LT((after.linear - before.linear).norm(), 1e-5 * before.speeds);
  EXPECT_LT((after.angular - before.angular).norm(), 1e-4 * before.moments);
  Vec3 center = Vec3::Zero();
  const Particles p = solver.particles();
  for (const Vec3& x : p.position) center += x / static_cast<double>(p.size());
  for (const Vec3& x : p.position) EXPECT_LT((x - center).norm(), 1.3 * 0.045) << "it came apart";
}

// One particle may take over some of its neighbours' energy, but they are within a spacing or two.
TEST(Conservation, ThinLiquidOffTheSidesOfStairsIsNotFasterThanFreeFall) {
  FluidOptions o;
  o.spacing = 0.08;
  o.kinematic_viscosity = 0.02;
  const auto points = test::block({-0.9, 0.8, -0.4}, {-0.1, 1.28, 0.4}, o.spacing);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3(1.5, 0, 0)),
                     solid_walls(test::stairs(4, 0.2, 0.5, 0.8)));
  double highest = 0;
  for (const Vec3& x : points) highest = std::max(highest, x.y());
  while (solver.time() < 1) {
    const FluidStep step = solver.step(1 - solver.time());
    double lowest = highest;
    for (const Vec3& x : solver.particles().position) lowest = std::min(lowest, x.y());
    ASSERT_LT(step.fastest, 1.1 * std::sqrt(1.5 * 1.5 + 2 * 9.81 * (highest - lowest))) << solver.time();
  }
}

// In units of sqrt(g h).
TEST(Conservation, LiquidOverAStepStaysAtRest) {
  FluidOptions o;
  o.spacing = 0.05;
  o.kinematic_viscosity = 0.05;
  std::vector<Vec3> points = test::block({0, 0.2, 0}, {0.2, 0.4, 0.2}, o.spacing);
  const auto beside = test::block({0.2, 0, 0}, {0.5, 0.4, 0.2}, o.spacing);
  points.insert(points.end(), beside.begin(), beside.end());
  const std::vector walls{test::box_surface({-0.2, -0.2, -0.2}, {0.7, 0, 0.4}),
                          test::box_surface({-0.2, -0.2, -0.2}, {0.2, 0.2, 0.4}),
                          test::box_surface({-0.2, -0.2, -0.2}, {0, 0.6, 0.4}),
                          test::box_surface({0.5, -0.2, -0.2}, {0.7, 0.6, 0.4}),
                          test::box_surface({-0.2, -0.2, -0.2}, {0.7, 0.6, 0}),
                          test::box_surface({-0.2, -0.2, 0.2}, {0.7, 0.6, 0.4})};
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()), solid_walls(walls));
  while (solver.time() < 1.5) {
    const FluidStep step = solver.step(1.5 - solver.time());
    if (solver.time() > 0.75) {
      ASSERT_LT(step.fastest, 0.05 * std::sqrt(9.81 * 0.4)) << solver.time();
    }
  }
}

}  // namespace
}  // namespace kappaflow
