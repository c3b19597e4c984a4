#include "scenes/estimate.h"

#include <gtest/gtest.h>

#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

SceneEstimate estimate_of(const Scene& scene, int threads) {
  return estimate(prepare(scene), threads);
}

Scene tank(double spacing) {
  Scene scene;
  scene.duration = 1;
  scene.fluid.spacing = spacing;
  add_block(scene, BoxShape{Vec3(0, 0, 0), Vec3(1, 1, 1)});
  add_wall(scene, BoxShape{Vec3(-1, -1, -1), Vec3(2, 0, 2)});
  return scene;
}

TEST(Estimate, CountsParticles) {
  const SceneEstimate result = estimate_of(tank(0.1), 1);
  EXPECT_EQ(result.particles, 1000u);
  EXPECT_EQ(result.boundary_particles, 5700u);  // 30 m2 of wall, 1.9 per spacing^2
}

TEST(Estimate, CountsThoseOfBodies) {
  Scene scene = tank(0.1);
  SceneBody& body = scene.bodies.emplace_back();
  body.shape = BoxShape{Vec3(0, 2, 0), Vec3(1, 3, 1)};
  body.density = 500;
  EXPECT_EQ(estimate_of(scene, 1).boundary_particles, 5700u + 1140u);  // 6 m2 more
}

TEST(Estimate, MemoryGrowsWithTheParticles) {
  const double program = static_cast<double>(estimate_of(tank(0.5), 1).memory_bytes);  // eight particles
  EXPECT_LT(program, 5e7);
  const auto arrays = [&](double spacing) {
    return static_cast<double>(estimate_of(tank(spacing), 1).memory_bytes) - program;
  };
  EXPECT_GT(arrays(0.1), 1000 * 300);              // the solver alone
  EXPECT_NEAR(arrays(0.05) / arrays(0.1), 4, 1);   // sampling the walls, while these are most of it
  EXPECT_GT(arrays(0.0125) / arrays(0.025), 4.5);  // eight times the liquid, four times its surface
  EXPECT_LT(arrays(0.0125) / arrays(0.025), 8);
}

TEST(Estimate, TimeFollowsDurationMethodsStepsAndThreads) {
  const Scene scene = tank(0.05);
  const double seconds = estimate_of(scene, 1).seconds;
  EXPECT_GT(seconds, 0);
  Scene longer = scene, unfollowed = scene, slower = scene, on_a_grid = scene, smooth = scene;
  longer.duration = 10;
  EXPECT_GT(estimate_of(longer, 1).seconds, 9 * seconds);
  smooth.surface.kernels = Kernels::anisotropic;
  EXPECT_GT(estimate_of(smooth, 1).seconds, 1.03 * seconds);
  unfollowed.surface.methods.clear();
  EXPECT_LT(estimate_of(unfollowed, 1).seconds, seconds);
  on_a_grid.surface.methods = {"fresh-grid"};
  EXPECT_GT(estimate_of(on_a_grid, 1).seconds, 1.4 * seconds);
  slower.fluid.max_time_step /= 10;
  EXPECT_GT(estimate_of(slower, 1).seconds, 2 * seconds);
  EXPECT_LT(estimate_of(scene, 2).seconds, seconds);
  EXPECT_GT(estimate_of(scene, 2).seconds, seconds / 2);
}

TEST(Estimate, OfWallsBeyondAllMeasureIsTooMuch) {
  Scene scene = tank(0.1);
  add_wall(scene, BoxShape{Vec3::Constant(-1e20), Vec3(1e20, -2, 1e20)});
  const SceneEstimate result = estimate_of(scene, 1);
  EXPECT_EQ(result.boundary_particles, std::size_t{1} << 53);
  EXPECT_EQ(result.memory_bytes, std::size_t{1} << 53);
}

TEST(Estimate, WithoutWallsOrGravityStaysFinite) {
  Scene scene = tank(0.1);
  scene.walls.clear();
  scene.fluid.gravity = Vec3::Zero();
  EXPECT_TRUE(std::isfinite(estimate_of(scene, 1).seconds));
}

// A stream that piles up and folds.
constexpr const char* kPour = R"(
duration = 0.8
[fluid]
spacing = 0.005
density = 1050.0
dynamic_viscosity = 3.0
[[fluid.emitter]]
shape = "disc"
position = [0.0, 0.12, 0.0]
direction = [0.0, -1.0, 0.0]
radius = 0.012
speed = 0.5
[[wall]]
shape = "basin"
lower = [-0.06, 0.0, -0.06]
upper = [0.06, 0.05, 0.06]
thickness = 0.02
[surface]
methods = ["regional"]
)";

constexpr const char* kTwoThreads = R"(
duration = 1.2
[fluid]
spacing = 0.004
density = 1400.0
dynamic_viscosity = 14.0
surface_tension = 0.06
[[fluid.emitter]]
shape = "disc"
position = [-0.05, 0.07, 0.0]
direction = [0.0, -1.0, 0.0]
radius = 0.01
speed = 0.7
[[fluid.emitter]]
shape = "rectangle"
position = [0.11, 0.06, 0.0]
direction = [-1.0, 0.0, 0.0]
width = 0.024
height = 0.012
up = [0.0, 1.0, 0.0]
speed = 0.45
dynamic_viscosity = 1.4
end = 1.0
[[wall]]
shape = "box"
lower = [-0.16, -0.012, -0.1]
upper = [0.16, 0.0, 0.1]
[surface]
sigma = 2.5
methods = ["material"]
[output]
frames_per_second = 25.0
)";

constexpr const char* kDropIntoAPool = R"(
duration = 0.5
[fluid]
spacing = 0.02
kinematic_viscosity = 1e-5
[[fluid.block]]
shape = "box"
lower = [-0.3, 0.0, -0.2]
upper = [0.3, 0.12, 0.2]
[[fluid.block]]
shape = "sphere"
center = [0.0, 0.35, 0.0]
radius = 0.1
velocity = [0.0, -1.5, 0.0]
[[wall]]
shape = "basin"
lower = [-0.3, 0.0, -0.2]
upper = [0.3, 0.5, 0.2]
thickness = 0.08
[output]
frames_per_second = 50.0
)";

Scene shipped(const std::string& name) {
  return load_scene(KAPPAFLOW_SOURCE_DIR "/scenes/" + name + ".toml");
}

void expect_within_a_factor_of_two(double estimated, double recorded, const char* what) {
  EXPECT_GT(estimated, recorded / 2) << what;
  EXPECT_LT(estimated, recorded * 2) << what;
}

// What runs on one thread took: steps, vertices of the first method's surface at their most, and the
// processor's seconds on the machine that estimate.cpp speaks of.
TEST(Estimate, IsWithinAFactorOfTwoOfWhatRunsTook) {
  struct Recorded {
    const char* name;
    Scene scene;
    double steps, vertices, seconds;
  };
  Scene first_second = shipped("staircase");
  first_second.duration = 1;
  for (const auto& [name, scene, steps, vertices, seconds] :
       {Recorded{"staircase-small", shipped("staircase-small"), 80, 1242, 1.0},
        Recorded{"staircase, 1 s", first_second, 250, 7208, 27},
        Recorded{"two threads", parse_scene(kTwoThreads, "threads.toml"), 757, 4160, 9.5},
        Recorded{"splash", shipped("splash"), 351, 14096, 21.6},
        Recorded{"pour", parse_scene(kPour, "pour.toml"), 532, 3121, 4.8},
        Recorded{"drop", parse_scene(kDropIntoAPool, "drop.toml"), 152, 7150, 6.4}}) {
    SCOPED_TRACE(name);
    const SceneEstimate result = estimate_of(scene, 1);
    expect_within_a_factor_of_two(result.steps, steps, "steps");
    expect_within_a_factor_of_two(result.vertices, vertices, "vertices");
    expect_within_a_factor_of_two(result.seconds, seconds, "seconds");
  }
}

TEST(Estimate, CountsWhatEmittersMakeFromTheirStartOn) {
  Scene scene = parse_scene(kPour, "pour.toml");
  const double steady = estimate_of(scene, 1).particle_steps / estimate_of(scene, 1).steps;
  EXPECT_NEAR(steady, 1312 / 2.0, 150) << "half of those at the end, in the mean";
  scene.fluid.emitters[0].end = 0.2;
  EXPECT_NEAR(estimate_of(scene, 1).particle_steps / estimate_of(scene, 1).steps, 1312 / 4.0 * 7 / 8, 60);
}

// By hand: the longer of liquid/(ranks - S) and 3 - 0.6 * 2.5 (1 - 1/S).
TEST(Estimate, AsManyRanksFollowTheSurfacesAsPay) {
  SceneEstimate cost;
  cost.tracker_seconds = 2.5;
  const auto ranks_for = [&](double liquid, int ranks) {
    cost.liquid_seconds = liquid;
    cost.seconds = liquid + 3;
    return ranks_for_surfaces(cost, ranks);
  };
  EXPECT_EQ(ranks_for(1, 1), 0);
  EXPECT_EQ(ranks_for(1, 2), 1) << "3 instead of 3.5 s";
  EXPECT_EQ(ranks_for(20, 2), 0) << "20 instead of 13 s";
  EXPECT_EQ(ranks_for(20, 4), 1) << "6.7 s, with two 10";
  EXPECT_EQ(ranks_for(1, 3), 2) << "2.25 instead of 3 s";
  EXPECT_EQ(ranks_for(1, 100), 5) << "1.8, 1.75 with six";
  cost.tracker_seconds = 0;
  EXPECT_EQ(ranks_for(1, 3), 1) << "nothing is shared";
}

TEST(Estimate, EachRankThatFollowsSurfacesTakesMemory) {
  const Scene scene = shipped("staircase");
  const SceneEstimate cost = estimate_of(scene, 1);
  const auto memory = [&](int here) {
    return static_cast<double>(
        memory_with_ranks(scene, cost, {.share = 0.5, .surface_ranks = 3, .surface_ranks_here = here}));
  };
  EXPECT_NEAR(memory(3) - memory(1), 2 * (memory(2) - memory(1)), 10);
  EXPECT_GT(memory(2) - memory(1), 850.0 * static_cast<double>(cost.particles));
}

// The same column of something thicker, and of water that does not fall, stays whole.
TEST(Estimate, ThinLiquidThatFallsIsTorn) {
  Scene scene = shipped("splash");
  const double torn = estimate_of(scene, 1).vertices;
  scene.fluid.kinematic_viscosity = 1;
  const double whole = estimate_of(scene, 1).vertices;
  EXPECT_GT(torn, 4 * whole);
  scene.fluid.kinematic_viscosity = 1e-4;
  scene.fluid.gravity = Vec3::Zero();
  EXPECT_EQ(estimate_of(scene, 1).vertices, whole);
}

}  // namespace
}  // namespace kappaflow
