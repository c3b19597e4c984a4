#include "tools/runs/simulation.h"

#include <algorithm>
#include <memory>
#include <set>
#include <sstream>

#include "core/saved_state.h"
#include "surface/measure/surface_metrics.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/tools/everything_scene.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class Simulations : public Scratch {};

void expect_same(const Simulation& one, const Simulation& other) {
  EXPECT_EQ(one.liquid().time(), other.liquid().time());
  EXPECT_EQ(one.liquid().steps(), other.liquid().steps());
  const LiquidRecord of_one = one.liquid().record(), of_other = other.liquid().record();
  EXPECT_EQ(of_one.particles.pressure, of_other.particles.pressure);
  EXPECT_EQ(of_one.particles.source, of_other.particles.source);
  EXPECT_EQ(of_one.particles.temperature, of_other.particles.temperature);
  ASSERT_EQ(of_one.bodies.size(), of_other.bodies.size());
  for (std::size_t b = 0; b < of_one.bodies.size(); ++b) {
    const BodyState &x = of_one.bodies[b], &y = of_other.bodies[b];
    EXPECT_EQ(x.pose.rotation, y.pose.rotation);
    EXPECT_EQ(x.pose.translation, y.pose.translation);
    EXPECT_EQ(x.velocity.linear, y.velocity.linear);
    EXPECT_EQ(x.velocity.angular, y.velocity.angular);
  }
  EXPECT_EQ(one.particles().position, other.particles().position);
  EXPECT_EQ(one.particles().velocity, other.particles().velocity);
  EXPECT_TRUE(std::ranges::equal(one.tracers().position(), other.tracers().position()));
  EXPECT_TRUE(std::ranges::equal(one.tracers().lost(), other.tracers().lost()));
  for (std::size_t m = 0; m < one.surfaces().count(); ++m) {
    const TriangleMesh &a = one.surfaces().mesh(m), &b = other.surfaces().mesh(m);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.rest_position, b.rest_position);
    EXPECT_EQ(a.source, b.source);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.id, b.id);
  }
}

void expect_same(const SimulationReport& one, const SimulationReport& other) {
  EXPECT_EQ(one.density_error_mean, other.density_error_mean);
  EXPECT_EQ(one.density_error_max, other.density_error_max);
  EXPECT_EQ(one.viscosity_error, other.viscosity_error);
  ASSERT_EQ(one.surfaces.size(), other.surfaces.size());
  for (std::size_t m = 0; m < one.surfaces.size(); ++m) {
    const TrackerStep &a = one.surfaces[m], &b = other.surfaces[m];
    EXPECT_EQ(a.residual_max, b.residual_max);
    EXPECT_EQ(a.unprojected, b.unprojected);
    EXPECT_EQ(a.topology.vertices_born, b.topology.vertices_born);
    EXPECT_EQ(a.edits.splits, b.edits.splits);
    EXPECT_EQ(a.edits.collapses, b.edits.collapses);
    EXPECT_EQ(a.edits.flips, b.edits.flips);
  }
}

TEST_F(Simulations, SavedAndReadBackAfterEveryStepAreTheSame) {
  const PreparedScene scene = prepare(parse_scene(kEverythingScene, "everything.toml"));
  Simulation whole(scene);
  auto saved = std::make_unique<Simulation>(scene);
  int steps = 0;
  std::size_t topology_changes = 0;
  for (const double time : {0.025, 0.05, 0.075, 0.1, 0.13}) {
    whole.advance(time, [](const FluidStep&) { return true; });
    while (!saved->advance(time, [](const FluidStep&) { return false; })) {
      std::stringstream state;
      StateWriter(state, little_endian())(*saved);
      saved = std::make_unique<Simulation>(scene);
      StateReader archive(state);
      archive(*saved);
      ++steps;
    }
    expect_same(whole, *saved);
    const SimulationReport since = whole.take_report();
    expect_same(since, saved->take_report());
    for (const TrackerStep& surface : since.surfaces) topology_changes += surface.topology.replaced;
    if (HasFailure()) break;
  }
  EXPECT_GT(steps, 20);
  EXPECT_GT(topology_changes, 0u);
  EXPECT_GT(whole.particles().size(), 400u);
}

/// How many of the mesh's vertices have the source of the particle that is nearest to them now.
std::size_t of_nearest_particle(const Simulation& simulation, const TriangleMesh& mesh) {
  const std::vector<int> source = simulation.liquid().sources();
  const std::vector<Vec3>& position = simulation.particles().position;
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const auto nearest =
        std::ranges::min_element(position, {}, [&](const Vec3& x) { return (x - mesh.position[v]).norm(); });
    count += mesh.source[v] == source[nearest - position.begin()];
  }
  return count;
}

TEST_F(Simulations, VerticesHaveTheSourceOfTheNearestParticle) {
  Simulation simulation(prepare(parse_scene(kEverythingScene, "everything.toml")));
  const TriangleMesh& mesh = simulation.surfaces().mesh(1);
  EXPECT_EQ(of_nearest_particle(simulation, mesh), mesh.vertex_count());
  EXPECT_EQ(std::set<int>(mesh.source.begin(), mesh.source.end()), (std::set{0, 1}));
  // The second emitter, number 2, starts at 0.02 s, and its stream is born without parents.
  for (const double time : {0.025, 0.05, 0.075, 0.1, 0.13}) {
    simulation.advance(time, [](const FluidStep&) { return true; });
    EXPECT_GE(static_cast<double>(of_nearest_particle(simulation, mesh)),
              0.9 * static_cast<double>(mesh.vertex_count()))
        << time;
  }
  EXPECT_EQ(std::set<int>(mesh.source.begin(), mesh.source.end()), (std::set{0, 1, 2})) << "all are known";
}

// A stream into an outflow region, for three times as long as it takes to get there.
TEST_F(Simulations, TrackedSurfaceEndsWhereTheLiquidDoes) {
  Simulation simulation(prepare(parse_scene(R"(
duration = 0.8
[fluid]
spacing = 0.02
kinematic_viscosity = 0.005
[[fluid.emitter]]
shape = "disc"
position = [0, 0.2, 0]
direction = [1, 0, 0]
radius = 0.05
speed = 1.0
[[outflow]]
shape = "box"
lower = [0.2, -0.5, -0.5]
upper = [0.9, 0.5, 0.5]
)",
                                            "stream.toml")));
  for (double time = 0.1; time < 0.85; time += 0.1) {
    simulation.advance(time, [](const FluidStep&) { return true; });
    const TriangleMesh& mesh = simulation.surfaces().mesh();
    const double sigma = simulation.surfaces().length_scale(),
                 volume = area_and_volume(mesh.position, mesh.triangles).volume;
    const FreshIsosurface fresh = fresh_isosurface(simulation.field(), sigma);
    EXPECT_NEAR(volume / fresh.metrics.volume, 1, 0.03) << time;
    EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).components, fresh.metrics.topology.components)
        << time;
    double farthest = 0;
    for (const Vec3& x : mesh.position) farthest = std::max(farthest, x.x());
    EXPECT_LT(farthest, 0.2 + sigma);
  }
  EXPECT_GT(simulation.liquid().steps(), 150u);
  EXPECT_GT(simulation.liquid().record().taken[0], simulation.liquid().particles().size());
}

}  // namespace
}  // namespace kappaflow
