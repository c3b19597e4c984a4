// What a scene and its files make, once.
#include "scenes/prepared_scene.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/text_hash.h"
#include "scenes/estimate.h"
#include "scenes/shapes.h"
#include "scenes/wall_distance.h"
#include "solver/fluid_solver.h"
#include "tests/open_counter.h"
#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

/// A cube of 0.5 m of liquid above one of 1 m, both of them cube.obj, and a floor below.
constexpr std::string_view kCubes = R"(duration = 0.1
[fluid]
spacing = 0.1
kinematic_viscosity = 1.0
[[fluid.block]]
shape = "mesh"
file = "cube.obj"
scale = 0.5
translation = [0.25, 1.0, 0.25]
[[wall]]
shape = "mesh"
file = "cube.obj"
[[wall]]
shape = "box"
lower = [-1, -1, -1]
upper = [2, -0.5, 2]
[[wall.motion]]
velocity = [0, 0, 1]
)";

std::string cube() {
  return read_file(source_file("tests/data/meshes/cube.obj"));
}

TEST(PreparedScene, NeedsItsFilesNoMore) {
  const auto file = temporary_file("cubes.toml", kCubes), mesh = temporary_file("cube.obj", cube());
  const PreparedScene prepared = prepare(load_scene(file));
  std::filesystem::remove(file);
  std::filesystem::remove(mesh);
  const SceneEstimate cost = estimate(prepared, 1);
  EXPECT_EQ(cost.particles, 125u);
  EXPECT_GT(cost.vertices, 0);
  const FluidParticlesAtStart& start = prepared.start;
  FluidSolver solver(prepared.scene.fluid, start.position, start.velocity, prepared.walls, start.fluid);
  EXPECT_LE(solver.step(0.1).time_step, 0.1);
  EXPECT_EQ(solver.size(), 125u);
  EXPECT_NEAR(WallDistance(prepared.walls).depth({0.5, 0.75, 0.5}), 0.25, 1e-12);
}

TEST(PreparedScene, ReadsAMeshFileOnceHoweverOftenItIsNamed) {
  const auto file = temporary_file("cubes.toml", kCubes), mesh = temporary_file("cube.obj", cube());
  test::OpenCounter scene_opened(file), mesh_opened(mesh);
  if (!mesh_opened.works()) GTEST_SKIP() << "the system does not say who opens a file";
  prepare(load_scene(file));
  EXPECT_EQ(scene_opened.count(), 1);
  EXPECT_EQ(mesh_opened.count(), 1);
  std::ifstream(mesh).get();
  std::ifstream(mesh).get();
  EXPECT_EQ(mesh_opened.count(), 2) << "the counter itself";
}

TEST(PreparedScene, WallsAndTheirSolidsAreThoseOfTheScene) {
  temporary_file("cube.obj", cube());
  const PreparedScene prepared = prepare(load_scene(temporary_file("cubes.toml", kCubes)));
  ASSERT_EQ(prepared.walls.size(), 2u);
  EXPECT_NEAR(surface_area(prepared.walls[0].surface()), 6, 1e-12);
  EXPECT_EQ(prepared.walls[0].solids().size(), 1u);
  EXPECT_TRUE(prepared.walls[0].motion().at_rest());
  EXPECT_FALSE(prepared.walls[1].motion().at_rest());
  EXPECT_NEAR(prepared.block_area, 6 * 0.25, 1e-12);
}

TEST(PreparedScene, CopiesOfAWallShareItsSolids) {
  const auto walls = solid_walls(std::vector{box_surface({Vec3(0, 0, 0), Vec3(1, 1, 1)})});
  std::vector<SolidWall> copies;
  copies.push_back(walls[0]);
  const std::vector<SolidWall> later = walls_at(3, walls);
  EXPECT_EQ(copies[0].solids().data(), walls[0].solids().data());
  EXPECT_EQ(later[0].solids().data(), walls[0].solids().data()) << "it is at rest";
}

TEST(PreparedScene, HashIsThatOfTheTextAndTheMeshes) {
  temporary_file("cube.obj", cube());
  const auto file = temporary_file("cubes.toml", kCubes);
  EXPECT_EQ(prepare(load_scene(file)).hash, text_hash(std::string(kCubes) + cube() + cube()));
  temporary_file("cube.obj", cube() + "# another\n");
  EXPECT_EQ(prepare(load_scene(file)).hash,
            text_hash(std::string(kCubes) + cube() + "# another\n" + cube() + "# another\n"));
}

}  // namespace
}  // namespace kappaflow
