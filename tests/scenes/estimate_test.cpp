#include <gtest/gtest.h>

#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

Scene tank(double spacing) {
  Scene scene;
  scene.duration = 1;
  scene.fluid.spacing = spacing;
  add_block(scene, BoxShape{Vec3(0, 0, 0), Vec3(1, 1, 1)});
  add_wall(scene, BoxShape{Vec3(-1, -1, -1), Vec3(2, 0, 2)});
  return scene;
}

TEST(Estimate, CountsParticles) {
  const SceneEstimate result = estimate(tank(0.1), 1);
  EXPECT_EQ(result.particles, 1000u);
  EXPECT_EQ(result.boundary_particles, 5700u);  // 30 m2 of wall, 1.9 per spacing^2
}

TEST(Estimate, MemoryGrowsWithTheParticles) {
  const double program = static_cast<double>(estimate(tank(0.5), 1).memory_bytes);  // eight particles
  EXPECT_LT(program, 5e7);
  const auto arrays = [&](double spacing) {
    return static_cast<double>(estimate(tank(spacing), 1).memory_bytes) - program;
  };
  EXPECT_GT(arrays(0.1), 1000 * 300);              // the solver alone
  EXPECT_NEAR(arrays(0.05) / arrays(0.1), 4, 1);   // sampling the walls, while these are most of it
  EXPECT_GT(arrays(0.0125) / arrays(0.025), 4.5);  // eight times the liquid, four times its surface
  EXPECT_LT(arrays(0.0125) / arrays(0.025), 8);
}

TEST(Estimate, TimeFollowsDurationMethodsStepsAndThreads) {
  const Scene scene = tank(0.05);
  const double seconds = estimate(scene, 1).seconds;
  EXPECT_GT(seconds, 0);
  Scene longer = scene, unfollowed = scene, slower = scene;
  longer.duration = 10;
  EXPECT_GT(estimate(longer, 1).seconds, 9 * seconds);
  unfollowed.surface.methods.clear();
  EXPECT_LT(estimate(unfollowed, 1).seconds, seconds);
  slower.fluid.max_time_step /= 10;
  EXPECT_GT(estimate(slower, 1).seconds, 2 * seconds);
  EXPECT_LT(estimate(scene, 2).seconds, seconds);
  EXPECT_GT(estimate(scene, 2).seconds, seconds / 2);
}

TEST(Estimate, OfWallsBeyondAllMeasureIsTooMuch) {
  Scene scene = tank(0.1);
  add_wall(scene, BoxShape{Vec3::Constant(-1e20), Vec3(1e20, -2, 1e20)});
  const SceneEstimate result = estimate(scene, 1);
  EXPECT_EQ(result.boundary_particles, std::size_t{1} << 53);
  EXPECT_EQ(result.memory_bytes, std::size_t{1} << 53);
}

TEST(Estimate, WithoutWallsOrGravityStaysFinite) {
  Scene scene = tank(0.1);
  scene.walls.clear();
  scene.fluid.gravity = Vec3::Zero();
  EXPECT_TRUE(std::isfinite(estimate(scene, 1).seconds));
}

}  // namespace
}  // namespace kappaflow
