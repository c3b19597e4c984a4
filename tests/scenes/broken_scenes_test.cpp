// Every mistake yields one line that says where it is, what was found and what is allowed. The scenes of
// tests/data/scenes have one mistake each; the message stands beside each in a file that ends with .expected.
#include <gtest/gtest.h>

#include <random>

#include "scenes/estimate.h"
#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

constexpr std::string_view kSmallest =
    "duration = 1.0\n[fluid]\nspacing = 0.5\nkinematic_viscosity = 1.0\n"
    "[[fluid.block]]\nshape = \"box\"\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n";

class BrokenScene : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(BrokenScene, ReportsTheExpectedLine) {
  const std::filesystem::path scene = GetParam();
  EXPECT_EQ(load_error(scene) + "\n", read_file(std::filesystem::path(scene).replace_extension(".expected")));
}

INSTANTIATE_TEST_SUITE_P(Data, BrokenScene,
                         testing::ValuesIn(files_in(source_file("tests/data/scenes"), ".toml")),
                         [](const auto& scene) { return scene.param.stem().string(); });

TEST(BrokenScenes, AreMany) {
  EXPECT_GE(files_in(source_file("tests/data/scenes"), ".toml").size(), 80u);
}

TEST(BrokenScenes, ExitCodeIsThatOfInvalidInput) {
  try {
    load_scene("no/such/scene.toml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit_code(), 2);
    EXPECT_STREQ(error.what(), "no/such/scene.toml: no such file; allowed: a scene file (.toml)");
  }
}

TEST(BrokenScenes, DirectoryInsteadOfFile) {
  EXPECT_EQ(load_error(source_file("tests/data")), "data: found a directory; allowed: a scene file (.toml)");
}

TEST(BrokenScenes, EndlessFile) {
  EXPECT_THROW(load_scene("/dev/zero"), InvalidInput);
  EXPECT_EQ(load_error(temporary_file("long.toml", std::string(2 << 20, '#'))),
            "long.toml: the file is larger than 1048576 bytes; allowed: a scene file (.toml)");
}

TEST(BrokenScenes, ControlCharactersInAMeshName) {
  std::string text(kSmallest);
  text += "[[wall]]\nshape = \"mesh\"\nfile = \"a\\nb.stl\"\n";
  EXPECT_EQ(
      load_error(temporary_file("mesh.toml", text)),
      "mesh.toml:11:8: file in [[wall]] is \"a\\nb.stl\"; allowed: a string without control characters");
}

TEST(BrokenScenes, LongValuesAreCutBetweenCharacters) {
  std::string umlauts;
  for (int i = 0; i < 200; ++i) umlauts += "\u00fc";
  const std::string message = load_error(temporary_file("long.toml", "duration = \"" + umlauts + "\"\n"));
  EXPECT_EQ(message, "long.toml:1:12: duration in the scene is \"" + umlauts.substr(0, 60) +
                         "...\"; allowed: a number > 0 and <= 1000000 [s]");
}

TEST(GoodScenes, SmallestOneLoadsWithDefaults) {
  const Scene scene = load_scene(temporary_file("smallest.toml", kSmallest));
  EXPECT_EQ(scene.title, "smallest");
  EXPECT_EQ(scene.text, kSmallest);
  EXPECT_EQ(prepare(scene).start.position.size(), 8u);
  EXPECT_EQ(scene.fluid.density, FluidOptions().density);
  EXPECT_EQ(scene.fluid.gravity, FluidOptions().gravity);
  EXPECT_EQ(scene.surface.tracker.fairing.iterations, FairingOptions().iterations);
  EXPECT_FALSE(scene.surface.threshold);
  EXPECT_TRUE(scene.surface.remesh);
  EXPECT_TRUE(scene.surface.topology);
}

TEST(GoodScenes, ViscositiesBecomeFluids) {
  const std::string block = "[[fluid.block]]\nshape = \"sphere\"\nradius = 0.6\ncenter = ";
  const std::string text =
      "duration = 1.0\n[fluid]\nspacing = 0.5\ndensity = 2000.0\nkinematic_viscosity = 1.0\n" + block +
      "[0, 0, 0]\nkinematic_viscosity = 1.0\n" + block + "[4, 0, 0]\ndynamic_viscosity = 6000.0\n" + block +
      "[8, 0, 0]\n" + block + "[12, 0, 0]\nkinematic_viscosity = 3.0\n" + block +
      "[16, 0, 0]\nkinematic_viscosity = 5.0\n";
  const Scene scene = load_scene(temporary_file("fluids.toml", text));
  EXPECT_EQ(scene.fluid.more_viscosities, (std::vector<double>{3, 5}));
  std::vector<int> fluids;
  for (const FluidBlock& b : scene.blocks) fluids.push_back(b.fluid);
  EXPECT_EQ(fluids, (std::vector<int>{0, 1, 0, 1, 2}));
}

/// The law of a scene's fluid that is of this material; density 2000 kg/m3.
Rheology law_of(const std::string& keys) {
  return load_scene(temporary_file("material.toml",
                                   "duration = 1.0\n[fluid]\nspacing = 0.5\ndensity = 2000.0\n"
                                   "material = \"it\"\n[[material]]\nname = \"it\"\n" +
                                       keys +
                                       "[[fluid.block]]\nshape = \"box\"\nlower = [0, 0, 0]\n"
                                       "upper = [1, 1, 1]\n"))
      .fluid.rheology(0);
}

TEST(GoodScenes, MaterialsBecomeLaws) {
  EXPECT_TRUE(is_newtonian(law_of("model = \"newtonian\"\ndynamic_viscosity = 8.0\n")));
  const auto power =
      std::get<HerschelBulkley>(law_of("model = \"power-law\"\nconsistency = 4.0\nindex = 0.4\n"));
  EXPECT_EQ(Vec3(power.yield_stress, power.consistency, power.index), Vec3(0, 0.002, 0.4));
  EXPECT_EQ(power.regularisation, HerschelBulkley().regularisation);
  const auto bingham = std::get<HerschelBulkley>(
      law_of("model = \"bingham\"\nyield_stress = 6.0\nplastic_viscosity = 4.0\nregularisation = 9\n"));
  EXPECT_EQ(Vec3(bingham.yield_stress, bingham.consistency, bingham.index), Vec3(0.003, 0.002, 1));
  EXPECT_EQ(bingham.regularisation, 9);
  const auto carreau =
      std::get<Carreau>(law_of("model = \"carreau\"\nzero_shear_viscosity = 8.0\ntime_constant = 3.0\n"
                               "infinite_shear_viscosity = 2.0\nindex = 0.2\n"));
  EXPECT_EQ(Vec3(carreau.at_rest, carreau.sheared, carreau.time), Vec3(0.004, 0.001, 3));
  EXPECT_EQ(carreau.index, 0.2);
  const auto cross = std::get<Cross>(
      law_of("model = \"cross\"\nzero_shear_viscosity = 8.0\ntime_constant = 3.0\nexponent = 0.7\n"));
  EXPECT_EQ(Vec3(cross.at_rest, cross.sheared, cross.time), Vec3(0.004, 0, 3));
  EXPECT_EQ(cross.exponent, 0.7);
}

// Newtonian ones are told apart by their viscosities, the others by their names.
TEST(GoodScenes, MaterialsAreFluids) {
  const std::string block = "[[fluid.block]]\nshape = \"sphere\"\nradius = 0.6\ncenter = ";
  const std::string mud = "\"\nmodel = \"bingham\"\nyield_stress = 5.0\nplastic_viscosity = 1.0\n";
  const std::string text =
      "duration = 1.0\n[fluid]\nspacing = 0.5\nkinematic_viscosity = 1.0\n" + block +
      "[0, 0, 0]\nmaterial = \"mud\"\n" + block + "[4, 0, 0]\nmaterial = \"water\"\n" + block +
      "[8, 0, 0]\nmaterial = \"clay\"\n" + block + "[12, 0, 0]\nmaterial = \"mud\"\n" +
      "[[material]]\nname = \"mud" + mud + "[[material]]\nname = \"clay" + mud +
      "[[material]]\nname = \"water\"\nmodel = \"newtonian\"\nkinematic_viscosity = 1.0\n";
  const Scene scene = load_scene(temporary_file("materials.toml", text));
  std::vector<int> fluids;
  for (const FluidBlock& b : scene.blocks) fluids.push_back(b.fluid);
  EXPECT_EQ(fluids, (std::vector<int>{1, 0, 2, 1}));
  EXPECT_EQ(scene.materials, (std::vector<std::string>{"", "mud", "clay"}));
}

// [fluid] says the density of what does not say its own, [fluid]'s material included.
TEST(GoodScenes, MaterialsHaveDensities) {
  const std::string block = "[[fluid.block]]\nshape = \"sphere\"\nradius = 0.6\ncenter = ";
  const std::string oil = "model = \"newtonian\"\ndynamic_viscosity = 0.8\n";
  const std::string text =
      "duration = 1.0\n[fluid]\nspacing = 0.5\ndensity = 500\nmaterial = \"oil\"\n" + block + "[0, 0, 0]\n" +
      block + "[4, 0, 0]\nmaterial = \"tar\"\n" + block + "[8, 0, 0]\ndynamic_viscosity = 0.8\n" + block +
      "[12, 0, 0]\nkinematic_viscosity = 0.002\n" + "[[material]]\nname = \"oil\"\ndensity = 400\n" + oil +
      "[[material]]\nname = \"tar\"\n" + oil;
  const Scene scene = load_scene(temporary_file("densities.toml", text));
  std::vector<int> fluids;
  for (const FluidBlock& b : scene.blocks) fluids.push_back(b.fluid);
  EXPECT_EQ(fluids, (std::vector<int>{0, 1, 1, 2})) << "tar is 0.8 Pa s of 500 kg/m3";
  EXPECT_EQ(scene.fluid.density, 400);
  EXPECT_EQ(scene.fluid.viscosity(0), 0.002);
  EXPECT_EQ(scene.fluid.rest_density(1), 500);
  EXPECT_EQ(scene.fluid.viscosity(1), 0.0016);
  EXPECT_EQ(scene.fluid.rest_density(2), 500) << "as thick as oil, but not as light";
  EXPECT_EQ(scene.fluid.viscosity(2), 0.002);
}

// What no block or emitter is of does not count.
TEST(GoodScenes, LiquidThatIsNotThereHasNoDensity) {
  const std::string text =
      "duration = 1.0\n[fluid]\nspacing = 0.5\nkinematic_viscosity = 1.0\n[[fluid.block]]\nshape = "
      "\"sphere\"\n"
      "radius = 0.6\ncenter = [0, 0, 0]\nmaterial = \"gas\"\n[[material]]\nname = \"gas\"\ndensity = 0.57\n"
      "model = \"newtonian\"\nkinematic_viscosity = 1e-3\n";
  const FluidOptions fluid = load_scene(temporary_file("gas.toml", text)).fluid;
  EXPECT_EQ(fluid.least_density(), 0.57);
  EXPECT_EQ(fluid.largest_density(), 0.57);
  EXPECT_TRUE(may_meet(0.57, 57)) << "100 times but for rounding";
  EXPECT_FALSE(may_meet(0.57, 57.1));
}

TEST(GoodScenes, EmitterAloneIsAScene) {
  const std::string text =
      "duration = 1.0\n[fluid]\nspacing = 0.1\nkinematic_viscosity = 1.0\n"
      "[[fluid.emitter]]\nshape = \"rectangle\"\nwidth = 0.4\nheight = 0.2\n"
      "position = [0, 1, 0]\ndirection = [2, 0, 0]\nspeed = 3.0\nend = 0.5\n";
  const Scene scene = load_scene(temporary_file("emitter.toml", text));
  ASSERT_EQ(scene.fluid.emitters.size(), 1u);
  EXPECT_EQ(scene.fluid.emitters[0].end, 0.5);
  const SceneEstimate cost = estimate(prepare(scene), 1);
  EXPECT_EQ(cost.particles, 0u);
  EXPECT_EQ(cost.emitted, 8u * 15);  // 1.5 m of stream
}

TEST(GoodScenes, EveryKeyArrives) {
  const Scene scene = load_scene(source_file("tests/data/every_key.toml"));
  EXPECT_EQ(scene.title, "Every key \u2014 \u03ba");
  EXPECT_EQ(scene.duration, 2);
  const FluidOptions& fluid = scene.fluid;
  EXPECT_EQ(fluid.spacing, 0.25);
  EXPECT_EQ(fluid.density, 1200);
  EXPECT_DOUBLE_EQ(fluid.kinematic_viscosity, 2.0);  // 2400 Pa s / 1200 kg/m3
  EXPECT_EQ(fluid.slip_length, 0.05);
  EXPECT_EQ(fluid.surface_tension, 0.05);
  ASSERT_EQ(fluid.fluids(), 4u);
  EXPECT_EQ(fluid.viscosity(1), 7);
  EXPECT_EQ(scene.materials, (std::vector<std::string>{"", "", "paste", ""}));
  const auto paste = std::get<HerschelBulkley>(fluid.rheology(2));
  EXPECT_EQ(fluid.rest_density(1), 1200);
  EXPECT_EQ(fluid.rest_density(2), 600);
  EXPECT_EQ(fluid.rest_density(3), 1200);
  EXPECT_DOUBLE_EQ(paste.yield_stress, 0.04);  // over 600 kg/m3
  EXPECT_DOUBLE_EQ(paste.consistency, 0.02);
  EXPECT_EQ(paste.index, 0.5);
  EXPECT_EQ(paste.regularisation, 25);
  EXPECT_DOUBLE_EQ(fluid.viscosity(2), 0.04 * 25 + 0.02 * 5);
  EXPECT_DOUBLE_EQ(fluid.viscosity(3), 0.1);
  ASSERT_EQ(fluid.emitters.size(), 2u);
  const Emitter& emitter = fluid.emitters[0];
  EXPECT_EQ(std::get<RectangleMouth>(emitter.mouth).width, 0.8);
  EXPECT_EQ(std::get<RectangleMouth>(emitter.mouth).height, 0.4);
  EXPECT_EQ(std::get<RectangleMouth>(emitter.mouth).up, Vec3(1, 0, 0));
  EXPECT_EQ(emitter.position, Vec3(0, -2, 3));
  EXPECT_EQ(emitter.direction, Vec3(0, 0, 2));
  EXPECT_EQ(emitter.speed, 1.5);
  EXPECT_EQ(emitter.start, 0.1);
  EXPECT_EQ(emitter.end, 0.7);
  EXPECT_EQ(emitter.max_particles, 500u);
  EXPECT_EQ(emitter.fluid, 3);
  EXPECT_EQ(emitter.source, 3) << "after the three blocks";
  EXPECT_EQ(fluid.gravity, Vec3(0, 0, -9));
  EXPECT_EQ(fluid.cfl, 0.3);
  EXPECT_EQ(fluid.min_time_step, 1e-5);
  EXPECT_EQ(fluid.max_time_step, 0.004);
  EXPECT_EQ(fluid.density_tolerance, 0.001);
  EXPECT_EQ(fluid.divergence_tolerance, 0.002);
  EXPECT_EQ(fluid.max_pressure_iterations, 51);
  EXPECT_EQ(fluid.viscosity_tolerance, 0.003);
  EXPECT_EQ(fluid.max_viscosity_iterations, 52);
  ASSERT_EQ(scene.blocks.size(), 3u);
  EXPECT_EQ(scene.blocks[1].fluid, 1);
  EXPECT_EQ(scene.blocks[2].fluid, 2);
  EXPECT_EQ(std::get<MeshShape>(scene.blocks[2].shape).scale, 2);
  EXPECT_EQ(std::get<MeshShape>(scene.blocks[2].shape).translation, Vec3(-4, 0, 0));
  EXPECT_EQ(std::get<BoxShape>(scene.blocks[0].shape).upper, Vec3(1, 1, 1));
  EXPECT_EQ(std::get<SphereShape>(scene.blocks[1].shape).radius, 0.5);
  EXPECT_EQ(std::get<SphereShape>(scene.blocks[1].shape).center, Vec3(3, 0, 0));
  EXPECT_EQ(scene.blocks[1].velocity, Vec3(-1, 0, 2));
  ASSERT_EQ(scene.walls.size(), 6u);
  EXPECT_EQ(std::get<BoxShape>(scene.walls[0].shape).lower, Vec3(-5, -6, -5));
  const auto& stairs = std::get<StairsShape>(scene.walls[1].shape);
  EXPECT_EQ(stairs.steps, 3);
  EXPECT_EQ(Vec3(stairs.rise, stairs.run, stairs.landing), Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(Vec3(stairs.floor, stairs.width, stairs.thickness), Vec3(0.4, 0.5, 0.6));
  EXPECT_EQ(stairs.origin, Vec3(0, -4, 0));
  const auto& mesh = std::get<MeshShape>(scene.walls[2].shape);
  EXPECT_EQ(mesh.file, source_file("tests/data/meshes/cube.obj"));
  EXPECT_EQ(mesh.scale, 0.5);
  EXPECT_EQ(mesh.translation, Vec3(0, 5, 0));
  EXPECT_EQ(scene.walls[2].where.line, 63);
  EXPECT_TRUE(scene.walls[2].motion.at_rest());
  EXPECT_EQ(std::get<SphereShape>(scene.walls[3].shape).radius, 1.5);
  const auto& cylinder = std::get<CylinderShape>(scene.walls[4].shape);
  EXPECT_EQ(cylinder.from, Vec3(-4, 0, 0));
  EXPECT_EQ(cylinder.to, Vec3(-4, 2, 0));
  EXPECT_EQ(cylinder.radius, 0.75);
  const auto& basin = std::get<BasinShape>(scene.walls[5].shape);
  EXPECT_EQ(basin.lower, Vec3(5, 5, 5));
  EXPECT_EQ(basin.upper, Vec3(6, 7, 8));
  EXPECT_EQ(basin.thickness, 0.5);
}

TEST(GoodScenes, BodiesArrive) {
  const Scene scene = load_scene(source_file("tests/data/every_key.toml"));
  ASSERT_EQ(scene.bodies.size(), 4u);
  const SceneBody &ball = scene.bodies[0], &box = scene.bodies[1];
  EXPECT_EQ(std::get<SphereShape>(ball.shape).center, Vec3(0, 6, 5));
  EXPECT_EQ(ball.density, 2500);
  EXPECT_EQ(ball.mass, std::nullopt);
  EXPECT_EQ(ball.velocity, Vec3(0, -1, 2));
  EXPECT_EQ(ball.angular_velocity, Vec3(3, 2, 1));
  EXPECT_EQ(ball.friction, 0.25);
  EXPECT_EQ(ball.heat, (WallHeat{WallHeat::Kind::temperature, 400}));
  EXPECT_EQ(std::get<BoxShape>(box.shape).upper, Vec3(3, 7, 6));
  EXPECT_EQ(box.density, std::nullopt);
  EXPECT_EQ(box.mass, 12.5);
  EXPECT_EQ(box.friction, 0.5);
  EXPECT_EQ(box.heat, (WallHeat{WallHeat::Kind::flux, 50}));
  EXPECT_EQ(std::get<CylinderShape>(scene.bodies[2].shape).to, Vec3(4, 8, 0));
  EXPECT_EQ(std::get<MeshShape>(scene.bodies[3].shape).translation, Vec3(-6, 6, 0));
}

TEST(GoodScenes, HeatArrives) {
  const PreparedScene prepared = prepare(load_scene(source_file("tests/data/every_key.toml")));
  const FluidOptions& fluid = prepared.scene.fluid;
  ASSERT_TRUE(fluid.heat);
  const HeatOptions& heat = *fluid.heat;
  EXPECT_EQ(heat.temperature, 300);
  EXPECT_EQ(heat.ambient_temperature, 290);
  EXPECT_EQ(heat.convection, 10);
  EXPECT_EQ(heat.emissivity, 0.9);
  ASSERT_EQ(heat.fluids.size(), 4u);
  for (const HeatProperties& of : heat.fluids) EXPECT_EQ(of.specific_heat, 2000);
  EXPECT_EQ(heat.fluids[0].conductivity, 0.5);
  EXPECT_EQ(heat.fluids[2].conductivity, 0.25);
  EXPECT_FALSE(has_temperature_law(fluid.temperature_law(0)));
  EXPECT_EQ(std::get<Arrhenius>(fluid.temperature_law(2)).activation_energy, 5e4);
  EXPECT_EQ(std::get<Arrhenius>(fluid.temperature_law(2)).reference_temperature, 305);
  EXPECT_EQ(fluid.emitters[0].temperature, 350);
  using Kind = WallHeat::Kind;
  EXPECT_EQ(heat.walls,
            (std::vector<WallHeat>{{}, {}, {}, {Kind::temperature, 280}, {}, {Kind::flux, -200}}));
  const FluidParticlesAtStart& start = prepared.start;
  ASSERT_EQ(start.temperature.size(), start.position.size());
  for (std::size_t i = 0; i < start.position.size(); ++i)
    EXPECT_EQ(start.temperature[i], start.source[i] == 1 ? 310 : 300);
}

TEST(GoodScenes, WithoutHeatNothingHasATemperature) {
  const PreparedScene prepared = prepare(load_scene(temporary_file("cold.toml", std::string(kSmallest))));
  EXPECT_FALSE(prepared.scene.fluid.heat);
  EXPECT_TRUE(prepared.start.temperature.empty());
}

TEST(GoodScenes, WhatFlowsInAndOutArrives) {
  const FluidOptions fluid = load_scene(source_file("tests/data/every_key.toml")).fluid;
  EXPECT_TRUE(fluid.emitters[0].motion.at_rest());
  EXPECT_TRUE(fluid.emitters[0].ramp.empty());
  EXPECT_EQ(fluid.emitters[0].profile, FlowProfile::uniform);
  const Emitter& emitter = fluid.emitters[1];
  EXPECT_EQ(emitter.profile, FlowProfile::parabolic);
  EXPECT_EQ(emitter.ramp, (TimeTable<double>{{{0.25, 0.5}, {0.75, 1.25}}}));
  EXPECT_EQ(emitter.motion.axis, Vec3(0, 1, 0));
  EXPECT_EQ(emitter.motion.point, Vec3(6, 1, 2));
  ASSERT_EQ(emitter.motion.keys.size(), 2u);
  EXPECT_EQ(emitter.motion.keys[0], (BodyMotion::Key{0, Vec3(3, 2, 1), 1.5}));
  EXPECT_EQ(emitter.motion.keys[1], (BodyMotion::Key{1.5, Vec3(0, 0, 0), 0}));
  ASSERT_EQ(fluid.outflows.size(), 3u);
  EXPECT_EQ(std::get<BoxShape>(fluid.outflows[0].shape).lower, Vec3(7, -2, -3));
  EXPECT_EQ(std::get<SphereShape>(fluid.outflows[1].shape).radius, 0.7);
  EXPECT_EQ(std::get<CylinderShape>(fluid.outflows[2].shape).to, Vec3(9, 0, 4));
}

TEST(GoodScenes, GravityMayBeATableInTime) {
  std::string text(kSmallest);
  const std::string fluid = "[fluid]\n";
  text.insert(text.find(fluid) + fluid.size(), "gravity = [[0, 0, -9.81, 0], [1, 4, -2, 1.5]]\n");
  const Scene scene = load_scene(temporary_file("table.toml", text));
  EXPECT_EQ(scene.fluid.gravity_table, (TimeTable<Vec3>{{{0, {0, -9.81, 0}}, {1, {4, -2, 1.5}}}}));
  EXPECT_EQ(scene.fluid.gravity, Vec3(0, -9.81, 0));
}

TEST(GoodScenes, MotionsOfWallsArrive) {
  const PreparedScene prepared = prepare(load_scene(source_file("tests/data/every_key.toml")));
  const std::vector<SolidWall>& walls = prepared.walls;
  ASSERT_EQ(walls.size(), prepared.scene.walls.size());
  const BodyMotion& motion = walls[4].motion();
  EXPECT_EQ(motion.axis, Vec3(0, 0, 1));
  EXPECT_EQ(motion.point, Vec3(1, 2, 3));
  ASSERT_EQ(motion.keys.size(), 2u);
  EXPECT_EQ(motion.keys[0], (BodyMotion::Key{0, Vec3(1, 2, 3), -4}));
  EXPECT_EQ(motion.keys[1], (BodyMotion::Key{0.5, Vec3(0, 0, 0), 5}));
  EXPECT_TRUE(any_moves(walls));
  const auto before = surfaces_of(walls), moved = surfaces_of(walls_at(0.5, walls));
  EXPECT_EQ(moved[3].vertices, before[3].vertices);
  EXPECT_EQ(moved[4].vertices[0], motion.pose(0.5) * before[4].vertices[0]);
}

TEST(GoodScenes, EverySurfaceAndOutputKeyArrives) {
  const Scene scene = load_scene(source_file("tests/data/every_key.toml"));
  const SurfaceDescription& surface = scene.surface;
  EXPECT_EQ(surface.sigma, 2.5);
  EXPECT_EQ(surface.weights, WeightRule::normalised);
  EXPECT_EQ(surface.kernels, Kernels::anisotropic);
  EXPECT_EQ(surface.threshold, 0.5);
  EXPECT_EQ(surface.edge_length, 0.4);
  EXPECT_EQ(surface.methods, (std::vector<std::string>{"material", "total"}));
  EXPECT_EQ(surface.anchor, Anchor::particles);
  EXPECT_EQ(surface.motion_per_step, 0.35);
  EXPECT_EQ(surface.tracker.integrator, TimeIntegrator::rk4);
  EXPECT_EQ(surface.tracker.velocity.damping, 0.2);
  EXPECT_EQ(surface.tracker.velocity.speed_limit, 1.5);
  EXPECT_EQ(surface.tracker.velocity.row_scale, RowScale::metre);
  EXPECT_EQ(surface.tracker.projection.tolerance, 1e-5);
  EXPECT_EQ(surface.tracker.projection.step_limit, 0.3);
  EXPECT_EQ(surface.tracker.projection.reach, 0.9);
  EXPECT_EQ(surface.tracker.projection.iterations, 19);
  EXPECT_EQ(surface.tracker.fairing.iterations, 4);
  EXPECT_EQ(surface.tracker.fairing.moves, FairedVertices::all);
  EXPECT_EQ(surface.tracker.fairing.relaxation, 0.6);
  EXPECT_EQ(surface.tracker.fairing.rest_length_time, 0.7);
  EXPECT_FALSE(surface.remesh);
  EXPECT_FALSE(surface.topology);
  EXPECT_EQ(surface.tracker.remeshing.turn, 0.4);
  EXPECT_EQ(surface.tracker.remeshing.finest, 0.3);
  EXPECT_EQ(scene.output.frames_per_second, 12.5);
  EXPECT_TRUE(scene.output.report_axis.isApprox(Vec3(0, 0.6, 0.8), 1e-15));
  EXPECT_EQ(scene.output.checker_size, 3);
  EXPECT_EQ(scene.output.texture, TextureProjection::spherical);
  EXPECT_EQ(scene.output.checkpoint_interval, 10);
  EXPECT_EQ(scene.output.view.from, Vec3(0, -3, 1));
  EXPECT_EQ(scene.output.view.up, Vec3(0, 0, 1));
}

TEST(GoodScenes, UpInPicturesIsAgainstGravity) {
  std::string text(kSmallest);
  const std::string fluid = "[fluid]\n";
  text.insert(text.find(fluid) + fluid.size(), "gravity = [0, 0, -9.81]\n");
  const Scene scene = load_scene(temporary_file("z_up.toml", text));
  EXPECT_EQ(scene.output.view.up.normalized(), Vec3(0, 0, 1));
  EXPECT_TRUE(scene.output.view.from.isApprox(Vec3(0.9, -1, 0.65), 1e-12));
}

TEST(GoodScenes, WindowsLineEndsAndByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : kSmallest) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(load_error(temporary_file("crlf.toml", text)), "");
}

/// One line, with the file's name in front and nothing unprintable in it.
void expect_clean(const std::string& message, const std::string& file) {
  EXPECT_EQ(message.rfind(file + ":", 0), 0u) << message;
  for (const char c : message) EXPECT_FALSE(static_cast<unsigned char>(c) < 0x20 || c == 0x7F) << message;
}

TEST(BrokenScenes, BinaryAndOtherEncodings) {
  std::string random_bytes, utf16 = "\xFF\xFE";
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) random_bytes += static_cast<char>(random());
  for (const char c : kSmallest) (utf16 += c) += '\0';
  const std::string latin1 = "title = \"caf\xE9\"\n" + std::string(kSmallest);
  const std::string zero = std::string(kSmallest) + std::string("a\0b = 1\n", 8);
  const std::string nested = "a = " + std::string(100000, '[');
  for (const std::string& text : {random_bytes, utf16, latin1, zero, nested})
    expect_clean(load_error(temporary_file("rubbish.toml", text)), "rubbish.toml");
}

TEST(BrokenScenes, RandomDamageLoadsOrYieldsOneCleanLine) {
  const std::string good = read_file(source_file("tests/data/every_key.toml"));
  temporary_file("meshes/cube.obj", read_file(source_file("tests/data/meshes/cube.obj")));
  ASSERT_EQ(load_error(temporary_file("damaged.toml", good)), "");
  std::mt19937 random(7);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string text = good;
    for (int damage = 0; damage < 2; ++damage) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, random() % 20);
          break;
        case 2:
          text.insert(at, 1, "\n[]=\"'.,-9e#{}"[random() % 14]);
          break;
        default:
          text.resize(at + 1);
      }
    }
    const std::string message = load_error(temporary_file("damaged.toml", text));
    if (!message.empty()) expect_clean(message, "damaged.toml");
    refused += !message.empty();
  }
  EXPECT_GT(refused, 500);
  EXPECT_LT(refused, 1500);
}

}  // namespace
}  // namespace kappaflow
