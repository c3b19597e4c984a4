// The mesh takes the topology of the surface: merging, splitting, closing, opening, birth and death.
#include "surface/topology/topology.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdlib>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "core/solid_distance.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/topology/winding_numbers.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/topology/components_genus.h"

namespace kappaflow {
namespace {

constexpr double kEdge = 0.25;    // in sigma, which is 1 in all scenes
constexpr double kCoarse = 0.25;  // lattice of the isosurface that the mesh is to be like, in sigma
constexpr double kFine = 0.08;    // of one that tells thin necks and slits from none

using testing::ComponentsGenus, testing::topology_of;

TriangleMesh isosurface(const Field& field, double spacing) {
  TriangleMesh mesh = extract_isosurface(field, spacing);
  project_all(field, {}, mesh.position, mesh.unprojected);
  return mesh;
}

/// The largest distance of a vertex of one mesh from the other [m].
double distance(const TriangleMesh& from, const TriangleMesh& to) {
  const SolidDistance surface(TriangleSurface{to.position, to.triangles});
  double largest = 0;
  for (const Vec3& x : from.position) largest = std::max(largest, std::abs(surface.nearest(x).distance));
  return largest;
}

/// Particles with sigma 1 at any time.
using ParticlesAt = std::function<FieldParticles(double)>;

double full_weight(std::size_t, double) {
  return 1;
}

/// Particles at place(t) with weight(particle, t); their rates by differences.
ParticlesAt moving(std::function<std::vector<Vec3>(double)> place,
                   std::function<double(std::size_t, double)> weight = full_weight) {
  return [=](double t) {
    constexpr double kStep = 1e-5;
    FieldParticles particles;
    particles.position = place(t);
    const std::vector<Vec3> before = place(t - kStep), after = place(t + kStep);
    for (std::size_t i = 0; i < before.size(); ++i) {
      particles.velocity.emplace_back((after[i] - before[i]) / (2 * kStep));
      particles.sigma.push_back(1);
      particles.weight.push_back(weight(i, t));
      particles.weight_rate.push_back((weight(i, t + kStep) - weight(i, t - kStep)) / (2 * kStep));
    }
    return particles;
  };
}

TrackerOptions following(const char* method) {
  return {.method = velocity_method(method).evaluate,
          .velocity = {.damping = 0.1, .speed_limit = 1},
          .fairing = {.iterations = 3},
          .remeshing = {.edge_length = kEdge},
          .topology = {.follows_field = true}};
}

constexpr int kStepsPerFrame = 5;

/// The mesh as the lattice of the coarse isosurface sees it: what is thinner than that is left out.
ComponentsGenus seen_topology(const TriangleMesh& mesh, const Field& field) {
  return topology_of(seen_by_lattice(mesh, isosurface_lattice(field, kCoarse)));
}

/// A tracked surface that is compared with fresh isosurfaces at every frame.
class TrackedRun {
 public:
  TrackedRun(ParticlesAt particles, double threshold, const char* method = "material")
      : particles_(std::move(particles)),
        threshold_(threshold),
        tracker(initial_mesh(*field(0), kEdge, {}), following(method)) {}

  void advance(int count, double dt) {
    for (int n = 0; n < count; ++n) {
      testing::FunctionMotion motion(time_, time_ + dt, [&](double t) { return field(t); });
      const TrackerStep step = tracker.step(motion);
      time_ += dt;
      counts += step.topology;
      unprojected += step.unprojected;
      mesh_topology(tracker.mesh().position, tracker.mesh().triangles);  // throws where it is no manifold
      if (++steps % kStepsPerFrame != 0) continue;
      const auto now = field(time_);
      const TrackerStep settled = tracker.settle(*now);
      counts += settled.topology;
      unprojected += settled.unprojected;
      compare(*now);
    }
  }

 private:
  ParticlesAt particles_;
  double threshold_, time_ = 0;

  std::shared_ptr<const ParticleField> field(double t) const {
    return std::make_shared<ParticleField>(particles_(t), threshold_, t);
  }

  void compare(const Field& now) {
    const TriangleMesh &mesh = tracker.mesh(), fine = isosurface(now, kFine),
                       coarse = isosurface(now, kCoarse);
    const ComponentsGenus topology = topology_of(mesh);
    const bool same = topology == topology_of(fine) || topology == topology_of(coarse);
    ++frames;
    other_topology += !same;
    other_on_lattice += seen_topology(mesh, now) != topology_of(coarse);
    intersecting += self_intersections(mesh.position, mesh.triangles) > 0;
    angles_outside_max = std::max(angles_outside_max, angles_outside(mesh.position, mesh.triangles, 15, 140));
    components_max = std::max(components_max, topology.first);
    if (seen.empty() || seen.back() != topology) seen.push_back(topology);
    if (!same || mesh.triangles.empty()) return;
    ++measured;
    distance_max = std::max({distance_max, distance(fine, mesh), distance(mesh, fine)});
  }

 public:
  SurfaceTracker tracker;
  TopologyCounts counts;
  std::size_t unprojected = 0;
  int steps = 0, frames = 0, measured = 0, intersecting = 0, components_max = 0;
  int other_topology = 0;    // frames at which it was neither that of a fine nor of a coarse isosurface
  int other_on_lattice = 0;  // frames at which it was not the coarse one's on its lattice
  double angles_outside_max = 0;
  double distance_max = 0;            // to the fine one, either way; in the frames that were measured
  std::vector<ComponentsGenus> seen;  // of the mesh, one entry a change
};

TEST(Topology, TwoDropsMergeAndTheDumbbellPinchesOff) {
  // Centres 2 apart go to 1 and back again.
  const ParticlesAt particles = moving([](double t) {
    const double x = 0.75 + 0.25 * std::cos(2 * std::numbers::pi * t);
    return std::vector<Vec3>{{-x, 0, 0}, {x, 0, 0}};
  });
  for (const char* method : {"material", "regional"}) {
    TrackedRun run(particles, 0.3, method);
    run.advance(100, 0.01);
    EXPECT_EQ(run.seen, (std::vector<ComponentsGenus>{{2, 0}, {1, 0}, {2, 0}})) << method;
    EXPECT_EQ(run.other_topology, 0) << method;
    EXPECT_EQ(run.other_on_lattice, 0) << method;
    EXPECT_EQ(run.intersecting, 0) << method;
    EXPECT_EQ(run.unprojected, 0u) << method;
    EXPECT_EQ(run.counts.refused, 0u) << method;
    EXPECT_LE(run.counts.replaced, 6u) << method;
    EXPECT_LT(run.distance_max, 0.25 * kEdge) << method;
    EXPECT_EQ(run.measured, run.frames) << method;
  }
}

TEST(Topology, ATorusCloses) {
  const ParticlesAt particles = moving([](double t) {
    std::vector<Vec3> ring;
    for (int i = 0; i < 24; ++i) {
      const double angle = 2 * std::numbers::pi * i / 24;
      ring.push_back((1.6 - t) * Vec3(std::cos(angle), std::sin(angle), 0));
    }
    return ring;
  });
  TrackedRun run(particles, 1.2);
  run.advance(50, 0.02);
  EXPECT_EQ(run.seen, (std::vector<ComponentsGenus>{{1, 1}, {1, 0}}));
  EXPECT_EQ(run.other_topology, 0);
  EXPECT_EQ(run.other_on_lattice, 0);
  EXPECT_EQ(run.intersecting, 0);
  EXPECT_EQ(run.unprojected, 0u);
  EXPECT_LT(run.distance_max, 0.25 * kEdge);
  EXPECT_EQ(run.measured, run.frames);
}

TEST(Topology, DropsAreBornAndDie) {
  // One stays, one grows from nothing, one shrinks to nothing.
  const ParticlesAt particles = moving(
      [](double t) {
        return std::vector<Vec3>{{0.3 * t, 0, 0}, {3, 0.2 * t, 0}, {0, 3, 0.1 * t}};
      },
      [](std::size_t i, double t) { return i == 0   ? 1.0
                                           : i == 1 ? 2 * t
                                                    : std::max(0.0, 1 - 2 * t); });
  TrackedRun run(particles, 0.3);
  run.advance(50, 0.02);
  EXPECT_EQ(run.seen.front(), (ComponentsGenus{2, 0}));
  EXPECT_EQ(run.seen.back(), (ComponentsGenus{2, 0}));
  EXPECT_EQ(run.other_topology, 0);
  EXPECT_EQ(run.other_on_lattice, 0);
  EXPECT_EQ(run.intersecting, 0);
  EXPECT_EQ(run.unprojected, 0u);
  EXPECT_LT(run.distance_max, 0.25 * kEdge);
  EXPECT_EQ(run.measured, run.frames);
}

TEST(Topology, ASheetTearsOpenAndHeals) {
  // The middle of a square sheet gets thinner until it tears, and thicker again.
  const ParticlesAt particles = moving(
      [](double) {
        std::vector<Vec3> sheet;
        for (int j = -5; j <= 5; ++j)
          for (int i = -5; i <= 5; ++i) sheet.emplace_back(0.5 * i, 0.5 * j, 0);
        return sheet;
      },
      [](std::size_t i, double t) {
        const double x = 0.5 * (static_cast<double>(i % 11) - 5), y = 0.5 * (static_cast<double>(i / 11) - 5);
        return 1 - std::sin(std::numbers::pi * t) * std::exp(-(x * x + y * y));
      });
  TrackedRun run(particles, 1.2, "normal");
  run.advance(40, 0.025);
  EXPECT_EQ(run.seen.front(), (ComponentsGenus{1, 0}));
  EXPECT_EQ(run.seen.back(), (ComponentsGenus{1, 0}));
  EXPECT_TRUE(std::ranges::count(run.seen, ComponentsGenus{1, 1}) > 0);
  EXPECT_EQ(run.other_topology, 0);
  EXPECT_EQ(run.other_on_lattice, 0);
  EXPECT_EQ(run.intersecting, 0);
  EXPECT_LT(run.distance_max, 0.25 * kEdge);
  EXPECT_EQ(run.measured, run.frames);
}

/// How many random motions of 50 steps each; ctest -C long asks for many.
unsigned random_motions() {
  const char* wanted = std::getenv("KAPPAFLOW_MOTIONS");
  return wanted == nullptr ? 6 : static_cast<unsigned>(std::stoul(wanted));
}

/// Drops on straight paths through each other, from random places in a cube of half edge `reach`.
ParticlesAt random_motion(unsigned seed, std::size_t drops, double reach) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1, 1);
  std::vector<Vec3> start(drops), velocity(drops);
  for (Vec3& x : start) x = reach * Vec3(along(random), along(random), along(random));
  for (Vec3& v : velocity) v = 2 * Vec3(along(random), along(random), along(random));
  return moving([=](double t) {
    std::vector<Vec3> now = start;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] += t * velocity[i];
    return now;
  });
}

TEST(Topology, RandomMotions) {
  // Merging and parting all the time, with necks and slits thinner than the lattice on the way.
  int frames = 0, other_topology = 0, other_on_lattice = 0, intersecting = 0;
  std::size_t changes = 0;
  TopologyCounts counts;
  for (unsigned seed = 0; seed < random_motions(); ++seed) {
    TrackedRun run(random_motion(seed, 16, 2), 0.4);
    run.advance(50, 0.02);
    EXPECT_LT(run.distance_max, 0.25 * kEdge) << seed;
    EXPECT_GE(run.measured, 8) << seed;  // of 10 frames
    EXPECT_LT(run.angles_outside_max, 0.05) << seed;
    changes += run.seen.size() - 1;
    frames += run.frames;
    other_topology += run.other_topology;
    other_on_lattice += run.other_on_lattice;
    intersecting += run.intersecting;
    counts += run.counts;
  }
  EXPECT_GT(changes, 3 * random_motions());
  EXPECT_LE(other_topology, 0.05 * frames);
  EXPECT_EQ(other_on_lattice, 0);
  EXPECT_EQ(intersecting, 0);
  EXPECT_GT(counts.replaced, 50u);
  EXPECT_EQ(counts.refused, 0u);
}

TEST(Topology, HundredsOfPieces) {
  TrackedRun run(random_motion(2, 400, 8), 0.4);
  run.advance(20, 0.02);
  EXPECT_GT(run.components_max, 200);
  EXPECT_EQ(run.other_on_lattice, 0);
  EXPECT_EQ(run.intersecting, 0);
  EXPECT_EQ(run.unprojected, 0u);
  EXPECT_LT(run.distance_max, 0.25 * kEdge);
  EXPECT_GE(run.measured, 2);  // of 4: of so many pieces a speck is often seen by one lattice alone
  EXPECT_GT(run.counts.replaced, 100u);
}

TEST(Topology, SameBitsForAnyNumberOfThreads) {
  std::vector<TriangleMesh> result;
  for (const std::size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ParticlesAt particles = moving([](double t) {
      return std::vector<Vec3>{{-0.7 + t, 0, 0}, {0.7 - t, 0.2, 0}, {0, 1.3 - t, 0.1}};
    });
    TrackedRun run(particles, 0.3);
    std::ranges::transform(run.tracker.mesh().position, run.tracker.mesh().source.begin(), [](const Vec3& x) {
      return x[0] < -0.3 ? 0 : x[0] > 0.3 ? 1 : 2;
    });
    run.advance(16, 0.02);
    EXPECT_GT(run.counts.replaced, 0u);
    result.push_back(run.tracker.mesh());
  }
  EXPECT_EQ(result[0].position, result[1].position);
  EXPECT_EQ(result[0].rest_position, result[1].rest_position);
  EXPECT_EQ(result[0].source, result[1].source);
  EXPECT_EQ(result[0].id, result[1].id);
  EXPECT_EQ(result[0].triangles, result[1].triangles);
}

}  // namespace
}  // namespace kappaflow
