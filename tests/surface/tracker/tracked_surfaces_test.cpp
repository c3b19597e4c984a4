#include "surface/tracker/tracked_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/errors.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/normal.h"
#include "surface/remesh/initial_mesh.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1, kSpeed = 0.5;

/// Balls of particles of radius 0.4 that move along x; ids go through all of them.
Particles balls(double time, const std::vector<double>& x, const std::vector<double>& speed) {
  Particles particles;
  particles.time = time;
  for (std::size_t b = 0; b < x.size(); ++b)
    for (int k = 0; k < 9 * 9 * 9; ++k) {
      const Vec3 start = kSpacing * Vec3(k % 9 - 4, k / 9 % 9 - 4, k / 81 - 4);
      if (start.norm() > 0.4) continue;
      particles.id.push_back(static_cast<std::int64_t>(particles.id.size()));
      particles.position.push_back(start + Vec3(x[b] + time * speed[b], 0, 0));
      particles.velocity.emplace_back(speed[b], 0, 0);
    }
  return particles;
}

Particles ball(double time) {
  return balls(time, {0}, {kSpeed});
}
Particles two_drops(double time) {
  return balls(time, {-0.7, 0.7}, {kSpeed, -kSpeed});
}

MeshTopology topology_of(const TrackedSurfaces& surfaces) {
  return mesh_topology(surfaces.mesh().position, surfaces.mesh().triangles);
}

TEST(TrackedSurfaces, TwoDropsBecomeOnePieceByTheDefaults) {
  TrackedSurfaces surface(two_drops(0));
  EXPECT_EQ(topology_of(surface).components, 2);
  const std::int64_t first_vertices = surface.mesh().next_id;
  const double volume = area_and_volume(surface.mesh().position, surface.mesh().triangles).volume;
  for (int frame = 1; frame <= 8; ++frame) surface.advance(two_drops(0.1 * frame));
  EXPECT_DOUBLE_EQ(surface.time(), 0.8);
  EXPECT_EQ(topology_of(surface).components, 1);
  EXPECT_EQ(topology_of(surface).genus, 0);

  const TriangleMesh& mesh = surface.mesh();
  const double merged = area_and_volume(mesh.position, mesh.triangles).volume;
  EXPECT_LT(merged, 1.02 * volume) << "the drops overlap";
  EXPECT_GT(merged, 0.6 * volume);
  EXPECT_GT(vertices_older_than(mesh, first_vertices), mesh.vertex_count() / 2)
      << "the far sides are as they were";
  EXPECT_EQ(std::ranges::count(mesh.unprojected, 1), 0);
  for (const Vec3& x : mesh.position) {
    const ValueAndGradient at = surface.field().value_and_gradient(x);
    EXPECT_LT(std::abs(at.f), 1e-3 * at.g.norm() * surface.field_options().sigma);
  }
}

TEST(TrackedSurfaces, SigmaAndThresholdComeFromTheFirstParticles) {
  const Particles first = ball(0);
  const ParticleFieldOptions field = field_options({}, first.position);
  EXPECT_NEAR(field.sigma, 2 * kSpacing, 0.02 * 2 * kSpacing);
  // The field at each particle by Eq. 12, all pairs.
  std::vector<double> value;
  for (const Vec3& x : first.position) {
    double sum = 0;
    for (const Vec3& y : first.position)
      sum += std::pow(std::max(0.0, 1 - (x - y).squaredNorm() / (field.sigma * field.sigma)), 3);
    value.push_back(sum);
  }
  std::ranges::sort(value);
  EXPECT_GE(2 * field.threshold, value[value.size() / 2 - 1] - 1e-12);
  EXPECT_LE(2 * field.threshold, value[value.size() / 2] + 1e-12);

  const ParticleFieldOptions given = field_options({.sigma = 0.3, .spacing = 1, .threshold = 1.5}, {});
  EXPECT_EQ(given.sigma, 0.3);
  EXPECT_EQ(given.threshold, 1.5);
}

TEST(TrackedSurfaces, FastParticlesMoveSigmaAStep) {
  TrackedSurfaces surface(ball(0), {.spacing = kSpacing});
  const double instant = 1.12;  // 2.8 sigma on
  EXPECT_EQ(surface.steps_to(ball(instant)), 3);
  std::vector<double> starts, ends;
  EXPECT_TRUE(surface.step(ball(instant), [&](FieldMotion& step) {
    starts.push_back(step.t0());
    ends.push_back(step.t1());
    return true;
  }));
  ASSERT_EQ(ends.size(), 3u);
  EXPECT_EQ(starts, (std::vector<double>{0, ends[0], ends[1]}));
  EXPECT_NEAR(ends[0], instant / 3, 1e-15);
  EXPECT_EQ(ends[2], instant);
  EXPECT_EQ(surface.time(), instant);
  EXPECT_EQ(surface.particles().position, ball(instant).position);
  EXPECT_THROW(surface.steps_to(ball(1e9)), InvalidInput);
  EXPECT_THROW(surface.advance(ball(instant)), InvalidInput) << "no time has passed";

  const TrackedSurfaces undivided(ball(0), {.spacing = kSpacing, .motion_per_step = kInfinity});
  EXPECT_EQ(undivided.steps_to(ball(1e9)), 1);
}

TEST(TrackedSurfaces, AreStoppedBetweenSteps) {
  TrackedSurfaces surface(ball(0), {.spacing = kSpacing});
  int steps = 0;
  EXPECT_FALSE(surface.step(ball(1.12), [&](FieldMotion&) { return ++steps < 2; }));
  EXPECT_EQ(steps, 2);
}

// The same as trackers by hand, from one mesh and through the same motions.
TEST(TrackedSurfaces, AreTheTrackersThatTheyHold) {
  const SurfaceOptions options{
      .spacing = kSpacing, .threshold = 2, .velocities = {evaluate_normal, evaluate_regional}};
  TrackedSurfaces surfaces(ball(0), options);
  surfaces.advance(ball(0.48));

  const ParticleFieldOptions field{.sigma = 2 * kSpacing, .threshold = 2};
  for (std::size_t m = 0; m < 2; ++m) {
    const TrackerOptions by_hand{.method = std::get<VelocityFunction>(options.velocities[m]),
                                 .remeshing = {.edge_length = 0.5 * field.sigma},
                                 .topology = {.follows_field = true}};
    ParticleMotion motion(ball(0), ball(0.48), field);
    TriangleMesh start = initial_mesh(*motion.at(0), 0.5 * field.sigma, {});
    SurfaceTracker tracker(SurfaceTracker::settled(*motion.at(0), std::move(start), by_hand), by_hand);
    MotionPart first(motion, 0, 0.24), second(motion, 0.24, 0.48);
    tracker.step(first);
    tracker.step(second);
    tracker.settle(*motion.at(0.48));
    EXPECT_EQ(surfaces.mesh(m).position, tracker.mesh().position);
    EXPECT_EQ(surfaces.mesh(m).triangles, tracker.mesh().triangles);
    EXPECT_EQ(surfaces.mesh(m).id, tracker.mesh().id);
  }
  EXPECT_NE(surfaces.mesh(0).position, surfaces.mesh(1).position);
}

TEST(TrackedSurfaces, AFrameHasNormalsCurvaturesAndVelocities) {
  TrackedSurfaces surface(ball(0));
  surface.advance(ball(0.1));
  const SurfaceState state = surface.state();
  const Vec3 centre(0.1 * kSpeed, 0, 0);
  ASSERT_EQ(state.normal.size(), surface.mesh().vertex_count());
  for (std::size_t v = 0; v < state.normal.size(); ++v) {
    EXPECT_GT(state.normal[v].dot((surface.mesh().position[v] - centre).normalized()), 0.8);
    EXPECT_NEAR((state.motion.velocity[v] - Vec3(kSpeed, 0, 0)).norm(), 0, 1e-9);
    EXPECT_NEAR((surface.mesh().position[v] - surface.mesh().rest_position[v]).x(), centre.x(),
                0.2 * 2 * kSpacing);
  }
}

TEST(TrackedSurfaces, PointCloudsAreFollowedByTheirField) {
  const auto cloud = [](int frame) {  // 0.05 sigma a frame
    Particles p = ball(0.02 * frame);
    for (std::int64_t& id : p.id) id += 1000 * frame;
    p.velocity.assign(p.size(), Vec3::Zero());
    return p;
  };
  TrackedSurfaces surface(cloud(0), cloud(1), {.is_cloud = true});
  const std::vector<Vec3> velocity = surface.state().motion.velocity;
  const Vec3 mean =
      std::accumulate(velocity.begin(), velocity.end(), Vec3(0, 0, 0)) / static_cast<double>(velocity.size());
  EXPECT_LT((mean - Vec3(kSpeed, 0, 0)).norm(), 0.1 * kSpeed) << "the first frame knows the next";
  for (const Vec3& v : velocity) EXPECT_LT(v.norm(), 1.5 * kSpeed);
  for (int frame = 1; frame <= 10; ++frame) {
    EXPECT_EQ(surface.steps_to(cloud(frame)), 1);
    surface.advance(cloud(frame));
  }
  Vec3 moved = Vec3::Zero();
  const TriangleMesh& mesh = surface.mesh();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    moved += (mesh.position[v] - mesh.rest_position[v]) / static_cast<double>(mesh.vertex_count());
  EXPECT_NEAR((moved - Vec3(0.2 * kSpeed, 0, 0)).norm(), 0, 0.1 * 0.2 * kSpeed);
}

TEST(TrackedSurfaces, VerticesTakeTheSourceOfTheNearestParticle) {
  TrackedSurfaces surface(two_drops(0));
  std::vector<int> source(surface.particles().size());
  for (std::size_t i = 0; i < source.size(); ++i) source[i] = surface.particles().position[i].x() < 0 ? 4 : 7;
  surface.find_sources({});
  EXPECT_EQ(std::ranges::count(surface.mesh().source, kUnknownSource),
            static_cast<std::ptrdiff_t>(surface.mesh().vertex_count()));
  surface.find_sources(source);
  for (std::size_t v = 0; v < surface.mesh().vertex_count(); ++v)
    EXPECT_EQ(surface.mesh().source[v], surface.mesh().position[v].x() < 0 ? 4 : 7);
}

// An array that begins as a copy of what the mesh itself carries stays one through edits and changes of
// topology.
TEST(TrackedSurfaces, ArraysOfAProgramAreCarriedAlong) {
  TrackedSurfaces surface(two_drops(0));
  surface.add_array<double>("start height", Carry::interpolate, 0);
  surface.add_array<int>("drop", Carry::nearest, -1);
  for (std::size_t v = 0; v < surface.mesh().vertex_count(); ++v) {
    surface.array<double>("start height")[v] = surface.mesh().rest_position[v].y();
    surface.array<int>("drop")[v] = surface.mesh().rest_position[v].x() < 0 ? 0 : 1;
  }
  const std::int64_t first_vertices = surface.mesh().next_id;
  for (int frame = 1; frame <= 8; ++frame) surface.advance(two_drops(0.1 * frame));
  const TriangleMesh& mesh = surface.mesh();
  ASSERT_LT(vertices_older_than(mesh, first_vertices), mesh.vertex_count()) << "there are new vertices";
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(surface.array<double>("start height")[v], mesh.rest_position[v].y(), 1e-12);
    if (mesh.id[v] < first_vertices) {
      EXPECT_EQ(surface.array<int>("drop")[v], mesh.rest_position[v].x() < 0 ? 0 : 1);
    }
  }
}

TEST(TrackedSurfaces, ReportWhatHappenedSinceTheLastReport) {
  TrackedSurfaces surface(two_drops(0));
  std::size_t replaced = 0;
  for (int frame = 1; frame <= 8; ++frame) {
    surface.advance(two_drops(0.1 * frame));
    const std::vector<TrackerStep> report = surface.take_report();
    ASSERT_EQ(report.size(), 1u);
    EXPECT_GT(report[0].velocity_seconds, 0);
    EXPECT_EQ(report[0].unprojected, 0u);
    replaced += report[0].topology.replaced;
    EXPECT_EQ(surface.take_report()[0].topology.replaced, 0u);
  }
  EXPECT_GT(replaced, 0u) << "the drops met";
}

TEST(TrackedSurfaces, AnEmptySurfaceIsRefusedByName) {
  try {
    const TrackedSurfaces surface(ball(0), {.threshold = 1e3, .name = "the splash"});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_STREQ(error.what(),
                 "the splash: the surface is empty: the field stays below its threshold everywhere");
  }
}

}  // namespace
}  // namespace kappaflow
