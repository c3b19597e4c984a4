#include "solver/surface_tension.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr double kSpacing = 0.01;

FluidOptions options(double tension) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 1e-3;
  o.surface_tension = tension;
  o.gravity.setZero();
  return o;
}

std::vector<Vec3> at_rest(std::size_t n) {
  return std::vector<Vec3>(n, Vec3::Zero());
}

Liquid blob_under(double tension, float time_step) {
  const auto points = test::blob(0.06, kSpacing);
  Liquid liquid(points, at_rest(points.size()), static_cast<float>(kSpacing));
  SurfaceTension(options(tension)).apply(liquid.particles, liquid.lists, time_step);
  return liquid;
}

TEST(SurfaceTension, ForcesHaveNeitherSumNorMoment) {
  const Liquid liquid = blob_under(1, 1);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double size = 0;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const Vec3 x = liquid.particles.position[i].head<3>().cast<double>(),
               a = liquid.particles.velocity[i].head<3>().cast<double>();
    force += a;
    moment += x.cross(a);
    size += a.norm();
  }
  EXPECT_GT(size, 1);
  EXPECT_LT(force.norm(), 1e-6 * size);
  EXPECT_LT(moment.norm(), 1e-5 * size * 0.06);
}

TEST(SurfaceTension, IsLinearInTheTensionAndNothingWithout) {
  const Liquid one = blob_under(1, 1e-3f), two = blob_under(2, 1e-3f), none = blob_under(0, 1);
  for (std::size_t i = 0; i < one.particles.size(); ++i) {
    EXPECT_LT((2 * one.particles.velocity[i] - two.particles.velocity[i]).norm(),
              1e-5 * two.particles.velocity[i].norm() + 1e-9f);
    EXPECT_EQ(none.particles.velocity[i], Vec4f(Vec4f::Zero()));
  }
}

// Deep inside a lattice there is no force; at the surface the sum of force times place is negative, as it
// must be where growing costs energy.
TEST(SurfaceTension, ActsAtTheSurfaceAndInward) {
  const auto points = test::block(Vec3::Constant(-0.06), Vec3::Constant(0.06), kSpacing);
  Liquid liquid(points, at_rest(points.size()), static_cast<float>(kSpacing));
  SurfaceTension(options(1)).apply(liquid.particles, liquid.lists, 1);
  double virial = 0, largest = 0, inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 x = liquid.particles.position[i].head<3>().cast<double>(),
               a = liquid.particles.velocity[i].head<3>().cast<double>();
    virial += a.dot(x);
    largest = std::max(largest, a.norm());
    if (x.cwiseAbs().maxCoeff() < 0.026) inside = std::max(inside, a.norm());
  }
  EXPECT_LT(virial, 0);
  EXPECT_LT(inside, 1e-4 * largest);
}

// A cube of liquid becomes a ball.
TEST(SurfaceTension, RoundsACube) {
  const auto points = test::block(Vec3::Constant(-0.04), Vec3::Constant(0.04), kSpacing);
  FluidSolver solver(options(2), points, at_rest(points.size()), {});
  const auto reach = [&] {  // of the furthest particle, over the radius of a ball of the same volume
    double r = 0;
    for (const Vec3& x : solver.particles().position) r = std::max(r, x.norm());
    return r / (0.08 * std::cbrt(3 / (4 * M_PI)));
  };
  EXPECT_GT(reach(), 1.2);
  while (solver.time() < 0.6) solver.step(0.6 - solver.time());
  EXPECT_LT(reach(), 1.08);
  EXPECT_GT(reach(), 0.85);
}

TEST(SurfaceTension, CapillaryStepFollowsItsFormula) {
  EXPECT_TRUE(std::isinf(capillary_time_step(0, 1000, 0.01)));
  EXPECT_NEAR(capillary_time_step(0.07, 1000, 0.01), std::sqrt(1e-3 / (4 * M_PI * 0.07)), 1e-12);
  FluidOptions o = options(100);
  const std::vector<Vec3> one{Vec3::Zero()};
  EXPECT_LE(FluidSolver(o, one, one, {}).step(1).time_step, capillary_time_step(100, 1000, kSpacing));
  o.surface_tension = 1e12;
  EXPECT_THROW(FluidSolver(o, one, one, {}), InvalidInput);
  o.surface_tension = -1;
  EXPECT_THROW(FluidSolver(o, one, one, {}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
