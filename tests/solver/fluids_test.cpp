// Several fluids with their own viscosities.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "solver/viscosity.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f;

Liquid two_fluids(const std::vector<Vec3>& points, const std::vector<Vec3>& velocity) {
  Liquid liquid(points, velocity, kSpacing);
  for (std::size_t i = 0; i < points.size(); ++i)
    liquid.particles.fluid[i] = liquid.particles.position[i].y() > 0;
  return liquid;
}

FluidOptions options(double a, double b) {
  FluidOptions o;
  o.spacing = 0.1;
  o.kinematic_viscosity = a;
  o.more_viscosities = {b};
  o.viscosity_tolerance = 1e-6;
  return o;
}

std::vector<Vec4f> applied(const Liquid& liquid, const FluidOptions& o) {
  std::vector<Vec4f> result;
  ViscositySolver(o).apply(liquid.particles, liquid.lists, liquid.wall_sums, 1, liquid.particles.velocity,
                           result);
  return result;
}

TEST(Fluids, EqualViscositiesAreOneFluid) {
  const auto points = test::blob(0.4, 0.1);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(std::sin(7 * x.y()), x.x() * x.z(), 0);
  const Liquid liquid = two_fluids(points, velocity);
  FluidOptions one = options(0.7, 0.7);
  one.more_viscosities.clear();
  const auto a = applied(liquid, options(0.7, 0.7)), b = applied(Liquid(points, velocity, kSpacing), one);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-5 * b[i].norm() + 1e-6f);
}

TEST(Fluids, SystemIsSymmetricAndKeepsMomentum) {
  const auto points = test::blob(0.35, 0.1);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(std::sin(7 * x.y()), std::cos(5 * x.z()), x.x());
  Liquid liquid = two_fluids(points, velocity);
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      const Vec3 x = liquid.particles.position[i].head<3>().cast<double>(),
                 v = liquid.particles.velocity[i].head<3>().cast<double>();
      sum.head<3>() += v;
      sum.tail<3>() += x.cross(v);
    }
    return sum;
  };
  const auto before = momenta();
  ViscositySolver(options(1, 0.01)).solve(liquid.particles, liquid.lists, liquid.wall_sums, 4e-3f);
  EXPECT_LT((momenta() - before).norm(), 1e-5 * before.norm());
}

// A velocity that shears with rates inverse to the viscosities has the same stress on both sides, so that no
// layer away from the free faces is accelerated; with the arithmetic mean the two at the interface would be.
TEST(Fluids, StressIsContinuousAcrossTheirInterface) {
  const auto points = test::block({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 0.1);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(x.y() > 0 ? x.y() / 0.1 : x.y(), 0, 0);
  const Liquid liquid = two_fluids(points, velocity);
  const auto image = applied(liquid, options(1, 0.1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (liquid.particles.position[i].head<3>().cwiseAbs().maxCoeff() > 0.26f) continue;
    // In units of nu (velocity step) / spacing^2 = 100 m/s2 between layers.
    EXPECT_NEAR(image[i][0] - liquid.particles.velocity[i][0], 0, 5)
        << liquid.particles.position[i].transpose();
  }
}

// A thick block lies on a thin one in a container, and the other way round. Nothing is faster than what falls
// from the top.
TEST(Fluids, ThickBesideThinStaysQuietAndTakesFewIterations) {
  for (const auto& [below, above] : {std::pair(200.0, 0.02), std::pair(0.02, 200.0)}) {
    FluidOptions o = options(below, above);
    o.viscosity_tolerance = FluidOptions().viscosity_tolerance;
    const auto points = test::block(Vec3::Zero(), Vec3::Ones(), o.spacing);
    std::vector<std::uint8_t> fluid;
    for (const Vec3& x : points) fluid.push_back(x.y() > 0.5);
    FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                       solid_walls(test::container(1, 1.5, 0.2)), fluid);
    int steps = 0, iterations = 0;
    for (; solver.time() < 0.4; ++steps) {
      const FluidStep step = solver.step(0.4 - solver.time());
      ASSERT_LT(step.fastest, std::sqrt(2 * 9.81 * 1)) << below << " " << solver.time();
      iterations += step.viscosity_iterations;
    }
    EXPECT_LT(iterations, 12 * steps) << below;
  }
}

TEST(Fluids, MistakesAreRefused) {
  const std::vector<Vec3> points{Vec3::Zero(), Vec3(1, 0, 0)};
  const std::vector<std::uint8_t> good{0, 1}, unknown{0, 2}, few{0};
  EXPECT_NO_THROW(FluidSolver(options(1, 2), points, points, {}, good));
  EXPECT_THROW(FluidSolver(options(1, 2), points, points, {}, unknown), InvalidInput);
  EXPECT_THROW(FluidSolver(options(1, 2), points, points, {}, few), InvalidInput);
  EXPECT_THROW(FluidSolver(options(1, -2), points, points, {}, good), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
