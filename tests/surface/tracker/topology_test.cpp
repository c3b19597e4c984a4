// The mesh takes the topology of the surface: merging, splitting, closing, opening, birth and death.
#include "surface/tracker/topology.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <functional>
#include <numbers>
#include <random>

#include "core/solid_distance.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "surface/tracker/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

constexpr double kEdge = 0.25;  // in sigma, which is 1 in all scenes

/// Particles with sigma 1 at any time.
using ParticlesAt = std::function<FieldParticles(double)>;

/// place(t) of each particle and its weight; velocities by differences.
ParticlesAt moving(std::function<std::vector<Vec3>(double)> place,
                   std::function<double(std::size_t, double)> weight = [](std::size_t, double) { return 1.0; }) {
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

/// The largest distance of a vertex of one mesh from another [m].
double distance(const TriangleMesh& from, const TriangleMesh& to) {
  const SolidDistance surface(TriangleSurface{to.position, to.triangles});
  double largest = 0;
  for (const Vec3& x : from.position) largest = std::max(largest, std::abs(surface.nearest(x).distance));
  return largest;
}

/// What happened in a run.
struct Summary {
  int steps = 0, other_topology = 0;  ///< steps where components or genus differed from the isosurface's
  int intersecting = 0, folded = 0;
  double distance_max = 0, volume_max = 0;  ///< where the topology is the same; relative
  TopologyCounts counts;
  std::vector<MeshTopology> seen;  ///< of the mesh, each change once
};

class TrackedRun {
 public:
  TrackedRun(ParticlesAt particles, double threshold, const TrackerOptions& options)
      : particles_(std::move(particles)),
        threshold_(threshold),
        tracker(initial_mesh(*field(0), kEdge, {}), options) {}

  std::shared_ptr<const ParticleField> field(double t) const {
    return std::make_shared<ParticleField>(particles_(t), threshold_, t);
  }

  void advance(double dt) {
    testing::FunctionMotion motion(time_, time_ + dt, [&](double t) { return field(t); });
    const TrackerStep step = tracker.step(motion);
    time_ += dt;
    summary.counts.replaced += step.topology.replaced;
    summary.counts.refused += step.topology.refused;
    summary.counts.triangles_removed += step.topology.triangles_removed;
    summary.counts.vertices_born += step.topology.vertices_born;
    compare(*field(time_));
  }

 private:
  ParticlesAt particles_;
  double threshold_;
  double time_ = 0;

  void compare(const Field& now) {
    const TriangleMesh& mesh = tracker.mesh();
    ++summary.steps;
    TriangleMesh fresh = extract_isosurface(now, 0.25);
    project_all(now, {}, fresh.position, fresh.unprojected);
    const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles),
                       expected = mesh_topology(fresh.position, fresh.triangles);
    TriangleMesh fine_mesh = extract_isosurface(now, 0.08);
    project_all(now, {}, fine_mesh.position, fine_mesh.unprojected);
    const MeshTopology fine = mesh_topology(fine_mesh.position, fine_mesh.triangles);
    const auto equal = [&](const MeshTopology& other) {
      return topology.components == other.components && topology.genus == other.genus;
    };
    const bool same = equal(expected) || equal(fine);
    if (getenv("TOPO_VERBOSE"))
      printf("%3d t %.3f  components %d/%d genus %d/%d fine %d %d  unprojected %ld  counts %zu %zu %zu %zu dist %.3f %.3f int %zu\n",
             summary.steps, time_, topology.components, expected.components, topology.genus, expected.genus, fine.components, fine.genus,
             (long)std::ranges::count(mesh.unprojected, 1), summary.counts.replaced, summary.counts.refused,
             summary.counts.triangles_removed, summary.counts.vertices_born,
             fresh.triangles.empty() || mesh.triangles.empty() ? 0 : distance(fine_mesh, mesh),
             fresh.triangles.empty() || mesh.triangles.empty() ? 0 : distance(mesh, fine_mesh), self_intersections(mesh.position, mesh.triangles));
    summary.other_topology += !same;
    summary.intersecting += self_intersections(mesh.position, mesh.triangles) > 0;
    if (summary.seen.empty() || summary.seen.back().components != topology.components ||
        summary.seen.back().genus != topology.genus)
      summary.seen.push_back(topology);
    if (!same || mesh.triangles.empty()) return;
    summary.distance_max = std::max({summary.distance_max, distance(fine_mesh, mesh), distance(mesh, fine_mesh)});
    const double volume = area_and_volume(mesh.position, mesh.triangles).volume;
    summary.volume_max = std::max(
        summary.volume_max,
        std::abs(volume / area_and_volume(fine_mesh.position, fine_mesh.triangles).volume - 1));
  }

 public:
  SurfaceTracker tracker;
  Summary summary;
};

TrackerOptions following(const char* method) {
  return {.method = method,
          .velocity = {.damping = 0.1, .speed_limit = 1},
          .fairing = {.iterations = 3},
          .remeshing = {.edge_length = kEdge},
          .topology = {.follows_field = true, .lattice_interval = getenv("TOPO_N") ? atoi(getenv("TOPO_N")) : 8}};
}

TEST(Topology, TwoDropsMergeAndPart) {
  // Centres 2 apart go to 1 and back again.
  const ParticlesAt particles = moving([](double t) {
    const double x = 0.75 + 0.25 * std::cos(2 * std::numbers::pi * t);
    return std::vector<Vec3>{{-x, 0, 0}, {x, 0, 0}};
  });
  for (const char* method : {"material", "regional"}) {
    TrackedRun run(particles, 0.3, following(method));
    for (int n = 0; n < 100; ++n) run.advance(0.01);
    EXPECT_EQ(run.summary.seen.size(), 3u) << method;
    EXPECT_LE(run.summary.other_topology, 8) << method;
    EXPECT_EQ(run.summary.intersecting, 0) << method;
    EXPECT_LT(run.summary.distance_max, 0.25 * kEdge) << method;
    EXPECT_LT(run.summary.volume_max, 0.005) << method;
  }
}

TEST(Topology, TorusCloses) {
  const ParticlesAt particles = moving([](double t) {
    std::vector<Vec3> ring;
    for (int i = 0; i < 24; ++i) {
      const double angle = 2 * std::numbers::pi * i / 24;
      ring.push_back((1.6 - 1.0 * t) * Vec3(std::cos(angle), std::sin(angle), 0));
    }
    return ring;
  });
  TrackedRun run(particles, 1.2, following("material"));
  for (int n = 0; n < 100; ++n) run.advance(0.01);
  EXPECT_EQ(run.summary.seen.size(), 2u);
  EXPECT_LE(run.summary.other_topology, 8);
  EXPECT_EQ(run.summary.intersecting, 0);
  EXPECT_LT(run.summary.distance_max, 0.25 * kEdge);
}

TEST(Topology, DropsAreBornAndDie) {
  const ParticlesAt particles = moving(
      [](double t) {
        return std::vector<Vec3>{{0.3 * t, 0, 0}, {3, 0.2 * t, 0}, {0, 3, 0.1 * t}};
      },
      [](std::size_t i, double t) { return i == 0 ? 1.0 : i == 1 ? 2 * t : std::max(0.0, 1 - 2 * t); });
  TrackedRun run(particles, 0.3, following("material"));
  for (int n = 0; n < 50; ++n) run.advance(0.02);
  EXPECT_EQ(run.summary.intersecting, 0);
  EXPECT_LE(run.summary.other_topology, 8);
  EXPECT_LT(run.summary.distance_max, 0.25 * kEdge);
}

TEST(Topology, ASheetTearsOpenAndHeals) {
  // The middle of a square sheet gets thinner until it tears.
  const ParticlesAt particles = moving(
      [](double) {
        std::vector<Vec3> sheet;
        for (int j = -6; j <= 6; ++j)
          for (int i = -6; i <= 6; ++i) sheet.emplace_back(0.5 * i, 0.5 * j, 0);
        return sheet;
      },
      [](std::size_t i, double t) {
        const double x = 0.5 * (static_cast<double>(i % 13) - 6), y = 0.5 * (static_cast<double>(i / 13) - 6);
        return 1 - std::sin(std::numbers::pi * t) * std::exp(-(x * x + y * y));
      });
  TrackedRun run(particles, 1.2, following("normal"));
  for (int n = 0; n < 50; ++n) run.advance(0.02);
  EXPECT_EQ(run.summary.intersecting, 0);
  EXPECT_LE(run.summary.other_topology, 8);
  EXPECT_LT(run.summary.distance_max, 0.25 * kEdge);
}

TEST(Topology, RandomMotions) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> along(-1, 1);
    std::vector<Vec3> start(16), velocity(16);
    for (Vec3& x : start) x = 2.0 * Vec3(along(random), along(random), along(random));
    for (Vec3& v : velocity) v = 2.0 * Vec3(along(random), along(random), along(random));
    const ParticlesAt particles = moving([=](double t) {
      std::vector<Vec3> now = start;
      for (std::size_t i = 0; i < now.size(); ++i) now[i] += t * velocity[i];
      return now;
    });
    TrackedRun run(particles, 0.4, following("material"));
    for (int n = 0; n < 50; ++n) run.advance(0.02);
    printf("seed %u: steps off %d of %d, intersecting %d, distance %.3f volume %.4f, replaced %zu refused %zu\n", seed,
           run.summary.other_topology, run.summary.steps, run.summary.intersecting, run.summary.distance_max,
           run.summary.volume_max, run.summary.counts.replaced, run.summary.counts.refused);
    EXPECT_EQ(run.summary.intersecting, 0) << seed;
    EXPECT_LT(run.summary.distance_max, 0.5 * kEdge) << seed;
  }
}

}  // namespace
}  // namespace kappaflow
