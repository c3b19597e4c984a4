#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "surface/field/particle_motion.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/material.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/tracker/moving_ellipsoid.h"

namespace kappaflow {
namespace {

using testing::FunctionMotion;
using testing::moved_with_ellipsoid;
using testing::moving_ellipsoid;

constexpr double kPi = std::numbers::pi;

double trajectory_error(TimeIntegrator integrator, int steps) {
  const TriangleMesh start = initial_mesh(*moving_ellipsoid(0, 1).at(0), 0.3, {.tolerance = 1e-13});
  SurfaceTracker tracker(start, {.method = evaluate_material,
                                 .integrator = integrator,
                                 .projection = {.tolerance = 1e-13},
                                 .fairing = {.iterations = 0}});
  for (int n = 0; n < steps; ++n) {
    auto motion = moving_ellipsoid(2.0 * n / steps, 2.0 * (n + 1) / steps);
    EXPECT_EQ(tracker.step(motion).unprojected, 0u);
  }
  double largest = 0;
  for (std::size_t v = 0; v < start.vertex_count(); ++v)
    largest =
        std::max(largest, (tracker.mesh().position[v] - moved_with_ellipsoid(start.position[v], 2)).norm());
  return largest;
}

TEST(Tracker, IntegratorsHaveTheirOrder) {
  const auto order = [](TimeIntegrator integrator, int steps) {
    return std::log2(trajectory_error(integrator, steps) / trajectory_error(integrator, 2 * steps));
  };
  EXPECT_NEAR(order(TimeIntegrator::euler, 80), 1, 0.15);
  EXPECT_NEAR(order(TimeIntegrator::rk2, 40), 2, 0.15);
  EXPECT_NEAR(order(TimeIntegrator::rk4, 20), 4, 0.25);
}

TEST(Tracker, RefusesAnUnknownMethod) {
  EXPECT_THROW(SurfaceTracker(TriangleMesh{}, {.method = nullptr}), InvalidInput);
}

std::vector<Vec3> three_on_a_circle(double radius) {
  std::vector<Vec3> centre;
  for (int i = 0; i < 3; ++i)
    centre.push_back(testing::rotation(2 * kPi / 3 * i * Vec3::UnitZ()) * Vec3(radius, 0, 0));
  return centre;
}

TEST(Tracker, ReproducesATranslationWithFairing) {
  Particles at_t0;
  for (int i = 0; i < 27; ++i) {
    at_t0.id.push_back(i);
    at_t0.position.push_back(0.5 * Vec3(i % 3, i / 3 % 3, i / 9) +
                             0.1 * Vec3(std::sin(i), std::cos(2 * i), std::sin(3 * i)));
    at_t0.velocity.push_back(Vec3(0.4, -0.3, 0.2));
  }
  const ParticleFieldOptions options{.sigma = 1, .threshold = 1.5};
  const TriangleMesh start = initial_mesh(*particle_field(at_t0, options), 0.25, {});
  SurfaceTracker tracker(start, {.method = evaluate_material});
  for (int n = 0; n < 5; ++n) {
    Particles at_t1 = at_t0;
    at_t1.time += 0.1;
    for (Vec3& x : at_t1.position) x += 0.1 * Vec3(0.4, -0.3, 0.2);
    ParticleMotion motion(at_t0, at_t1, options);
    const TrackerStep step = tracker.step(motion);
    EXPECT_EQ(step.unprojected, 0u);
    EXPECT_LE(step.residual_max, ProjectionOptions{}.tolerance);
    at_t0 = at_t1;
  }
  for (std::size_t v = 0; v < start.vertex_count(); ++v)
    EXPECT_LT((tracker.mesh().position[v] - start.position[v] - 0.5 * Vec3(0.4, -0.3, 0.2)).norm(), 1e-3);
}

TEST(Tracker, SameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<Vec3>> result;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    auto first = testing::turning_particles(0, 0.02, three_on_a_circle(0.5), 1, 0.3);
    auto second = testing::turning_particles(0.02, 0.04, three_on_a_circle(0.5), 1, 0.3);
    SurfaceTracker tracker(initial_mesh(*first.at(0), 0.12, {}),
                           {.method = evaluate_curvature, .velocity = {.damping = 1e-3, .speed_limit = 4}});
    tracker.step(first);
    tracker.step(second);
    result.push_back(tracker.mesh().position);
  }
  EXPECT_EQ(result[0], result[1]);
  EXPECT_EQ(result[0], result[2]);
}

TEST(Tracker, StageOutsideTheSupportStaysFiniteAndIsFlagged) {
  // The particle jumps by three radii in a step: the midpoint stage and the end lie outside its support.
  auto motion = FunctionMotion(0, 0.5, [](double t) -> std::shared_ptr<const Field> {
    FieldParticles particles = testing::rotating_particles({Vec3(6 * t, 0, 0)}, 1, 0);
    return std::make_shared<ParticleField>(particles, 0.3, t);
  });
  SurfaceTracker tracker(initial_mesh(*motion.at(0), 0.2, {}),
                         {.method = evaluate_curvature, .integrator = TimeIntegrator::rk4});
  const TrackerStep step = tracker.step(motion);
  EXPECT_EQ(step.unprojected, tracker.mesh().vertex_count());
  for (const Vec3& x : tracker.mesh().position) EXPECT_TRUE(x.allFinite());
  const SurfaceState state =
      surface_state(*motion.at(0.5), tracker.mesh(), tracker.rings(), tracker.options().method, {});
  for (std::size_t v = 0; v < state.normal.size(); ++v) {
    EXPECT_TRUE(state.normal[v].allFinite() && state.motion.velocity[v].allFinite());
    EXPECT_TRUE(std::isfinite(state.gaussian_curvature[v]) && std::isfinite(state.mean_curvature[v]));
  }
}

TEST(Tracker, EveryVertexIsOnTheSurfaceOrFlaggedInATearingFlow) {
  // Two blobs that are pulled apart: the neck tears and leaves vertices behind.
  const auto field_at = [](double t) -> std::shared_ptr<const Field> {
    FieldParticles particles = testing::rotating_particles({Vec3(-0.4 - t, 0, 0), Vec3(0.4 + t, 0, 0)}, 1, 0);
    particles.velocity = {Vec3(-1, 0, 0), Vec3(1, 0, 0)};
    return std::make_shared<ParticleField>(particles, 0.3, t);
  };
  SurfaceTracker tracker(initial_mesh(*field_at(0), 0.15, {}), {.method = evaluate_curvature});
  std::size_t flagged = 0, all = 0;
  for (int n = 0; n < 20; ++n) {
    FunctionMotion motion(0.05 * n, 0.05 * (n + 1), field_at);
    tracker.step(motion);
    const std::shared_ptr<const Field> field = motion.at(motion.t1());
    for (std::size_t v = 0; v < tracker.mesh().vertex_count(); ++v) {
      const ValueAndGradient at = field->value_and_gradient(tracker.mesh().position[v]);
      EXPECT_TRUE(tracker.mesh().unprojected[v] ||
                  std::abs(at.f) / at.g.norm() <= ProjectionOptions{}.tolerance);
      flagged += tracker.mesh().unprojected[v] != 0;
    }
    all += tracker.mesh().vertex_count();
  }
  EXPECT_GT(all, 20 * 300u);
  EXPECT_LT(flagged, all / 20) << "of whom nothing was asked";
}

}  // namespace
}  // namespace kappaflow
