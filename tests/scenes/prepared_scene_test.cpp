// What a scene and its files make, once.
#include "scenes/prepared_scene.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "core/errors.h"
#include "core/machine_memory.h"
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

TEST(PreparedScene, ParticlesMayComeLater) {
  temporary_file("cube.obj", cube());
  const auto file = temporary_file("cubes.toml", kCubes);
  const PreparedScene whole = prepare(load_scene(file));
  PreparedScene without = prepare_without_particles(load_scene(file));
  EXPECT_EQ(without.hash, whole.hash);
  EXPECT_EQ(without.walls.size(), whole.walls.size());
  EXPECT_TRUE(without.start.position.empty());
  add_particles(without);
  EXPECT_EQ(without.start.position, whole.start.position);
  EXPECT_EQ(without.start.source, whole.start.source);
  EXPECT_EQ(without.block_area, whole.block_area);

  Scene full = load_scene(file);
  full.blocks.push_back(full.blocks.front());
  PreparedScene unchecked = prepare_without_particles(full);
  EXPECT_THROW(prepare(full), InvalidInput);
  EXPECT_THROW(add_particles(unchecked), InvalidInput);
}

// 3.8e9 particles, 230 GB.
TEST(PreparedScene, OfMoreParticlesThanTheMachineHoldsIsRefusedAtOnce) {
  if (machine_memory() > std::size_t{200} << 30) GTEST_SKIP() << "this machine may hold them";
  const Scene scene = parse_scene(R"(duration = 0.1
[fluid]
spacing = 0.00064
kinematic_viscosity = 1.0
[[fluid.block]]
shape = "box"
lower = [0, 0, 0]
upper = [1, 1, 1]
)",
                                  "large.toml");
  try {
    prepare(scene);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("large.toml:5:1: the block would have 3.81e+09 particles"),
              std::string::npos)
        << error.what();
  }
  EXPECT_TRUE(prepare_without_particles(scene).start.position.empty());
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

/// A scene with a floor at y = 0, some liquid far away, and these bodies.
std::string floor_with(std::string_view bodies) {
  return std::string(R"(
duration = 1
[fluid]
spacing = 0.1
kinematic_viscosity = 1
[[fluid.block]]
shape = "box"
lower = [10, 0, 0]
upper = [11, 1, 1]
[[wall]]
shape = "box"
lower = [-5, -1, -5]
upper = [5, 0, 5]
)") + std::string(bodies);
}

std::string box_body(const Vec3& lower, const Vec3& upper) {
  return fmt::format("[[body]]\nshape = \"box\"\ndensity = 700\nlower = [{}, {}, {}]\nupper = [{}, {}, {}]\n",
                     lower[0], lower[1], lower[2], upper[0], upper[1], upper[2]);
}

PreparedScene prepared_with(const std::string& bodies) {
  return prepare(load_scene(temporary_file("bodies.toml", floor_with(bodies))));
}

TEST(PreparedScene, BodiesWeighWhatTheirShapesHold) {
  const PreparedScene prepared = prepared_with(
      "[[body]]\nshape = \"sphere\"\ncenter = [0, 2, 0]\nradius = 0.5\ndensity = 2500\nvelocity = [1, 2, "
      "3]\n" +
      box_body({2, 0, 0}, {3, 2, 0.5}) +
      "[[body]]\nshape = \"sphere\"\ncenter = [0, 4, 0]\nradius = 0.5\nmass = 12\n");
  ASSERT_EQ(prepared.bodies.size(), 3u);
  const double ball = 2500 * 4.0 / 3.0 * std::numbers::pi * 0.125;
  EXPECT_NEAR(prepared.bodies[0].mass, ball, 0.01 * ball) << "triangles within the sphere hold a little less";
  EXPECT_LT(prepared.bodies[0].mass, ball);
  EXPECT_NEAR(prepared.bodies[1].mass, 700, 1e-9);
  EXPECT_EQ(prepared.bodies[2].mass, 12);
  EXPECT_EQ(prepared.bodies[0].velocity, Vec3(1, 2, 3));
}

TEST(PreparedScene, BodiesMayTouchButNotOverlap) {
  const std::string box = box_body({0, 0, 0}, {1, 1, 1});
  const auto refused = [](const std::string& bodies) {
    try {
      prepared_with(bodies);
    } catch (const InvalidInput&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(box)) << "it stands on the floor";
  EXPECT_FALSE(refused(box + box_body({0, 1, 0}, {1, 2, 1}))) << "and the next one on it";
  EXPECT_FALSE(refused(box + box_body({0, 0.996, 0}, {1, 2, 1}))) << "0.04 spacings deep";
  EXPECT_TRUE(refused(box + box_body({0, 0.994, 0}, {1, 2, 1}))) << "0.06 spacings deep";
  EXPECT_TRUE(refused(box_body({0, -0.006, 0}, {1, 1, 1})));
  EXPECT_TRUE(refused(box + box_body({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7}))) << "within the other as a whole";
  EXPECT_TRUE(refused(box_body({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7}) + box));
  EXPECT_TRUE(refused(box + box_body({-1, 0.4, 0.4}, {2, 0.6, 0.6}))) << "no vertex of one is in the other";
  EXPECT_TRUE(refused(box_body({0, -2, 0}, {0.3, 2, 0.3}))) << "likewise, through the floor";
}

TEST(PreparedScene, BodiesAreFreeOfLiquid) {
  const std::string body =
      "[[body]]\nshape = \"sphere\"\ncenter = [10.5, 0.5, 0.5]\nradius = 0.3\ndensity = 2500\n";
  const std::size_t without = prepared_with("").start.position.size();
  const PreparedScene prepared = prepared_with(body);
  EXPECT_NEAR(static_cast<double>(without - prepared.start.position.size()),
              4.0 / 3.0 * std::numbers::pi * 0.35 * 0.35 * 0.35 / 1e-3, 25);
  for (const Vec3& x : prepared.start.position) EXPECT_GT((x - Vec3(10.5, 0.5, 0.5)).norm(), 0.34);
}

TEST(PreparedScene, HashTakesTheMeshesOfBodies) {
  temporary_file("cube.obj", cube());
  const std::string text =
      floor_with("[[body]]\nshape = \"mesh\"\nfile = \"cube.obj\"\ntranslation = [0, 3, 0]\ndensity = 500\n");
  EXPECT_EQ(prepare(load_scene(temporary_file("mesh.toml", text))).hash, text_hash(text + cube()));
}

}  // namespace
}  // namespace kappaflow
