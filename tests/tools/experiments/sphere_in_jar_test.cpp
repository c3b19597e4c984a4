#include "tools/experiments/sphere_in_jar.h"

#include <gtest/gtest.h>

#include <limits>

namespace kappaflow {
namespace {

SphereInJar sphere(double ratio, double inner_viscosity) {
  return {.radius = 0.3,
          .jar_radius = 0.3 / ratio,
          .excess_density = 50,
          .gravity = 10,
          .viscosity = 2,
          .inner_viscosity = inner_viscosity};
}

TEST(SphereInJar, IsStokesWithoutBoundsAndThreeHalvesOfThatForABubble) {
  const double stokes = 2.0 / 9 * 50 * 10 * 0.09 / 2, solid = std::numeric_limits<double>::infinity();
  EXPECT_DOUBLE_EQ(sphere(0.1, solid).unbounded_speed(), stokes);
  EXPECT_DOUBLE_EQ(sphere(0.1, 0).unbounded_speed(), 1.5 * stokes);
  EXPECT_DOUBLE_EQ(sphere(0.1, 2).unbounded_speed(), 1.2 * stokes) << "equal viscosities";
}

// Haberman & Sayre's own form for solid spheres.
TEST(SphereInJar, SolidSphereIsSlowedAsItIsKnown) {
  const double solid = std::numeric_limits<double>::infinity();
  for (const double l : {0.1, 0.3, 0.5}) {
    const double correction =
        (1 - 0.75857 * std::pow(l, 5)) /
        (1 - 2.105 * l + 2.0865 * std::pow(l, 3) - 1.7068 * std::pow(l, 5) + 0.72603 * std::pow(l, 6));
    const SphereInJar jar = sphere(l, solid);
    EXPECT_NEAR(jar.unbounded_speed() / jar.speed(), correction, 2e-3 * correction) << l;
  }
}

// A far wall sees nothing but the force, so that to first order it takes 2.105 l times the drag over that of
// a solid sphere (Brenner, "Effect of finite boundaries on the Stokes resistance of an arbitrary particle",
// 1962).
TEST(SphereInJar, FarWallsActByTheForceAlone) {
  for (const double inner : {0.0, 0.5, 2.0, 40.0}) {
    const SphereInJar jar = sphere(1e-3, inner);
    const double drag = (2.0 / 3 + inner / jar.viscosity) / (1 + inner / jar.viscosity);
    EXPECT_NEAR(1 - jar.speed() / jar.unbounded_speed(), 2.105e-3 * drag, 2e-6) << inner;
  }
}

}  // namespace
}  // namespace kappaflow
