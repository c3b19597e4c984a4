// The viscous solve of liquids whose viscosity depends on the shear rate, and what becomes of a heap of one
// with a yield stress.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "solver/viscosity.h"
#include "tests/solver/dense_system.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f, kTimeStep = 4e-3f;

FluidOptions options(const Rheology& law, double tolerance) {
  FluidOptions o;
  o.spacing = 0.1;
  o.rheologies = {law};
  o.slip_length = 0.05;
  o.viscosity_tolerance = tolerance;
  o.max_viscosity_iterations = 500;
  return o;
}

Liquid swirling_blob() {
  const auto points = test::blob(0.35, 0.1);
  std::vector<WallSample> wall;
  for (double x = -0.5; x < 0.5; x += 0.08)
    for (double z = -0.5; z < 0.5; z += 0.08) wall.push_back({Vec3(x, -0.43, z), Vec3::UnitY()});
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(std::sin(7 * x.y()), std::cos(5 * x.z()), x.x());
  return Liquid(points, velocity, kSpacing, wall);
}

const std::vector<Rheology> kLaws{HerschelBulkley{0, 0.5, 0.4, 100},
                                  HerschelBulkley{2, 0.3, 1, 100},
                                  HerschelBulkley{20, 0.3, 0.5, 1e3},
                                  HerschelBulkley{0, 0.3, 1.8, 100},
                                  HerschelBulkley{0, 0.3, 2, 100},
                                  Carreau{5, 0.01, 2, 0.3},
                                  Cross{5, 0.01, 2, 0.8}};

TEST(Yield, PowerLawOfIndexOneIsNewtonian) {
  FluidOptions newtonian = options({}, 1e-5);
  newtonian.kinematic_viscosity = 0.7;
  Liquid a = swirling_blob(), b = swirling_blob();
  ViscositySolver(newtonian).solve(a.particles, a.lists, a.wall_sums, kTimeStep);
  ViscositySolver(options(HerschelBulkley{0, 0.7, 1, 50}, 1e-5))
      .solve(b.particles, b.lists, b.wall_sums, kTimeStep);
  for (std::size_t i = 0; i < a.particles.size(); ++i)
    EXPECT_LT((a.particles.velocity[i] - b.particles.velocity[i]).norm(), 1e-4f);
}

// Another solve, a dense one, with the viscosities of the velocities that were found changes them by less
// than is tolerated.
TEST(Yield, SolvesTheNonlinearSystem) {
  for (const Rheology& law : kLaws) {
    Liquid liquid = swirling_blob();
    const Eigen::VectorXd start = test::stacked(liquid.particles.velocity);
    const FluidOptions o = options(law, 1e-2);
    ViscositySolver solver(o);
    const ViscositySolve solve = solver.solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
    EXPECT_LE(solve.error, 1) << law.index();
    EXPECT_GT(solve.systems, 1);
    const Eigen::VectorXd found = test::stacked(liquid.particles.velocity);
    ViscousForces(o).find_viscosities(liquid.particles, liquid.lists, liquid.wall_sums,
                                      liquid.particles.velocity);
    const Eigen::VectorXd next = test::dense_system(liquid, kTimeStep, solver).llt().solve(start);
    const double n = std::sqrt(static_cast<double>(liquid.particles.size()));
    const double fall = o.gravity.norm() * static_cast<double>(kTimeStep);
    const double scale = std::clamp(std::min((found - start).norm(), found.norm()) / n, 0.1 * fall, fall);
    EXPECT_LT((next - found).norm() / n, 1.5 * o.viscosity_tolerance * scale) << law.index();
  }
}

TEST(Yield, LiquidThatThickensTakesFewSystems) {
  for (const double index : {1.5, 1.8, 2.0}) {
    Liquid liquid = swirling_blob();
    const ViscositySolve solve = ViscositySolver(options(HerschelBulkley{0, 0.3, index, 100}, 1e-2))
                                     .solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
    EXPECT_LE(solve.error, 1) << index;
    EXPECT_LE(solve.systems, 8) << index;
  }
}

TEST(Yield, SaysWhenItHasNotConverged) {
  FluidOptions o = options(HerschelBulkley{20, 0.3, 0.5, 1e3}, 1e-3);
  o.max_viscosity_iterations = 4;
  Liquid liquid = swirling_blob();
  const ViscositySolve solve =
      ViscositySolver(o).solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  EXPECT_GT(solve.error, 1);
  EXPECT_EQ(solve.iterations, 4);
}

TEST(Yield, SystemIsSymmetric) {
  Liquid liquid = swirling_blob();
  const FluidOptions o = options(HerschelBulkley{20, 0.3, 0.5, 1e3}, 1e-3);
  ViscousForces(o).find_viscosities(liquid.particles, liquid.lists, liquid.wall_sums,
                                    liquid.particles.velocity);
  const ViscositySolver solver(o);
  std::vector<Vec4f> u, v, au, av;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const float s = static_cast<float>(i);
    u.emplace_back(std::sin(s), std::cos(2 * s), std::sin(3 * s), 0);
    v.emplace_back(std::cos(5 * s), std::sin(7 * s), std::cos(11 * s), 0);
  }
  solver.apply(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep, u, au);
  solver.apply(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep, v, av);
  double uav = 0, vau = 0, size = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    uav += static_cast<double>(u[i].dot(av[i]));
    vau += static_cast<double>(v[i].dot(au[i]));
    size += static_cast<double>(u[i].norm() * av[i].norm());
  }
  EXPECT_NEAR(uav, vau, 1e-6 * size);
}

// A heap 2 spacings high of a liquid that yields at more than its weight can do stays a cube; one that yields
// at less slumps, and then rests: less than a percent of its height a second.
TEST(Yield, HeapComesToRestAndStays) {
  for (const double yield : {0.2, 4.0}) {
    FluidOptions o = options(HerschelBulkley{yield, 0.05, 1, 1e3}, FluidOptions().viscosity_tolerance);
    o.max_viscosity_iterations = FluidOptions().max_viscosity_iterations;
    o.slip_length = 0;
    const auto points = test::block({-0.3, 0, -0.3}, {0.3, 0.6, 0.3}, 0.1);
    FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                       solid_walls(std::vector{test::box_surface({-1, -0.3, -1}, {1, 0, 1})}));
    const auto height = [&] {
      double top = 0;
      for (const Vec3& x : solver.particles().position) top = std::max(top, x.y() + 0.05);
      return top;
    };
    while (solver.time() < 1) solver.step(1 - solver.time());
    const double then = height();
    while (solver.time() < 2) EXPECT_LE(solver.step(2 - solver.time()).viscosity_error, 1);
    if (yield > 1)
      EXPECT_GT(height(), 0.57);
    else
      EXPECT_LT(height(), 0.45);
    EXPECT_NEAR(height(), then, 0.006) << yield;
  }
}

}  // namespace
}  // namespace kappaflow
