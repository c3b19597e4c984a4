#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "surface/field/particle_motion.h"
#include "surface/measure/material_tracers.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/material.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::FunctionMotion;
using testing::TorusField;

constexpr double kPi = std::numbers::pi;

EllipsoidField sphere(double radius) {
  return {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(radius)};
}

/// An ellipsoid that turns with a constant angular velocity while its centre moves.
auto moving_ellipsoid(double t0, double t1) {
  return FunctionMotion(t0, t1, [](double t) -> std::shared_ptr<const Field> {
    const Vec3 velocity(0.3, -0.1, 0.2), spin(0.6, 1.1, -0.7);
    return std::make_shared<EllipsoidField>(velocity * t, testing::rotation(spin * t), Vec3(1, 0.7, 0.5),
                                            velocity, spin, t);
  });
}

Vec3 moved_with_ellipsoid(const Vec3& x, double t) {
  return Vec3(0.3, -0.1, 0.2) * t + testing::rotation(Vec3(0.6, 1.1, -0.7) * t) * x;
}

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

TEST(State, GaussBonnetWithSecondOrder) {
  const TorusField torus(1, 0.4);
  const EllipsoidField ellipsoid(Vec3(0.2, 0, 0), testing::rotation(Vec3(1, 2, 3)), Vec3(1, 0.8, 0.6));
  const std::vector<std::pair<const Field*, double>> cases{{&torus, 0.0}, {&ellipsoid, 4 * kPi}};
  for (const auto& [field, expected] : cases) {
    std::vector<double> error;
    for (const double spacing : {0.2, 0.05}) {
      const TriangleMesh mesh = initial_mesh(*field, spacing, {.tolerance = 1e-10});
      const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
      const SurfaceState state = surface_state(*field, mesh, rings, velocity_method("normal").evaluate, {});
      double sum = 0;
      for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        sum += state.gaussian_curvature[v] * state.area[v];
      error.push_back(std::abs(sum - expected));
      EXPECT_FALSE(slip(state).has_value() && field == &torus);
    }
    EXPECT_GT(std::log2(error[0] / error[1]) / 2, 1.8);
    EXPECT_LT(error[1], 0.02);
  }
}

TEST(State, SphereHasItsCurvaturesAndOutwardNormals) {
  const EllipsoidField field = sphere(2);
  const TriangleMesh mesh = initial_mesh(field, 0.4, {.tolerance = 1e-12});
  const SurfaceState state = surface_state(field, mesh, vertex_rings(mesh.vertex_count(), mesh.triangles),
                                           velocity_method("normal").evaluate, {});
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(state.mean_curvature[v], 0.5, 1e-10);
    EXPECT_NEAR(state.gaussian_curvature[v], 0.25, 1e-10);
    EXPECT_LT((state.normal[v] - mesh.position[v] / 2).norm(), 1e-10);
  }
}

std::optional<double> captured(const TriangleMesh& mesh, const SurfaceState& state, const Vec3& axis) {
  return largest_piece_rotation(rotation_by_piece(mesh, state, axis));
}

TEST(State, MaterialCapturesTheRotationWithoutSlipAndNormalHasTheSlipOne) {
  const Vec3 spin(0.4, -0.2, 1.5);
  const EllipsoidField field(Vec3(5, 5, 5), testing::rotation(Vec3(1, 0, 2)), Vec3(1, 0.7, 0.5),
                             Vec3(1, 2, 3), spin);
  const TriangleMesh mesh = initial_mesh(field, 0.2, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const Vec3 axis = spin.normalized();
  const SurfaceState material = surface_state(field, mesh, rings, velocity_method("material").evaluate, {});
  EXPECT_LT(slip(material).value(), 1e-12);
  EXPECT_NEAR(captured(mesh, material, axis).value(), 1, 1e-12);
  EXPECT_LT((fitted_angular_velocity(mesh.position, material.area, material.motion.velocity) - spin).norm(),
            1e-12);

  const SurfaceState normal = surface_state(field, mesh, rings, velocity_method("normal").evaluate, {});
  EXPECT_NEAR(slip(normal).value(), 1, 1e-12);
  EXPECT_LT(captured(mesh, normal, axis).value(), 0.9);
}

TEST(State, RotationCapturedLooksAtTheLargestPieceOnly) {
  // A large blob that turns one way, a small one elsewhere that turns the other way.
  FieldParticles particles = testing::rotating_particles(
      {Vec3(0.5, 0, 0), Vec3(-0.5, 0, 0), Vec3(0, 0.6, 0), Vec3(9, 0, 0)}, 1, 2.0);
  particles.velocity[3] = Vec3(0, -30, 0);
  const ParticleField field(particles, 0.3, 0);
  const TriangleMesh mesh = initial_mesh(field, 0.15, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  SurfaceState state = surface_state(field, mesh, rings, velocity_method("material").evaluate, {});
  const double all = captured(mesh, state, Vec3::UnitZ()).value();
  EXPECT_NEAR(all, 1, 1e-12);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    if (mesh.position[v][0] > 5) state.motion.velocity[v] = Vec3(100, 100, 100);
  EXPECT_EQ(captured(mesh, state, Vec3::UnitZ()).value(), all);

  const std::vector<PieceRotation> pieces = rotation_by_piece(mesh, state, Vec3::UnitZ());
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[0].vertices + pieces[1].vertices, mesh.vertex_count());
  EXPECT_EQ(
      std::max(pieces[0], pieces[1], [](const auto& a, const auto& b) { return a.vertices < b.vertices; })
          .captured,
      all);
  EXPECT_FALSE(largest_piece_rotation({}).has_value());
}

TEST(State, NoRotationGivesNoValue) {
  const EllipsoidField moving(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.7, 0.5), Vec3(1, 0, 0));
  const TriangleMesh mesh = initial_mesh(moving, 0.2, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const SurfaceState state = surface_state(moving, mesh, rings, velocity_method("total").evaluate, {});
  EXPECT_FALSE(captured(mesh, state, Vec3::UnitZ()).has_value());
  EXPECT_TRUE(slip(state).has_value());
  const EllipsoidField still = sphere(1);
  const SurfaceState at_rest = surface_state(still, mesh, rings, velocity_method("normal").evaluate, {});
  EXPECT_FALSE(slip(at_rest).has_value());
}

TEST(State, AngularVelocityOfPointsOnALineHasNoPartAlongIt) {
  const std::vector<Vec3> position{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  const std::vector<Vec3> velocity{Vec3(0, 0, 0), Vec3(0, 3, 0), Vec3(0, 6, 0)};
  const std::vector<double> area{1, 1, 1};
  EXPECT_LT((fitted_angular_velocity(position, area, velocity) - Vec3(0, 0, 3)).norm(), 1e-12);
}

TEST(Tracers, FollowARigidBodyWithFourthOrder) {
  std::vector<double> error;
  for (const int steps : {10, 20}) {
    const TriangleMesh start = initial_mesh(*moving_ellipsoid(0, 1).at(0), 0.4, {});
    MaterialTracers tracers(start.position);
    for (int n = 0; n < steps; ++n) {
      auto motion = moving_ellipsoid(2.0 * n / steps, 2.0 * (n + 1) / steps);
      tracers.step(motion);
    }
    TriangleMesh exact = start;
    for (Vec3& x : exact.position) x = moved_with_ellipsoid(x, 2);
    error.push_back(tracer_distance(exact, tracers, 0.5).value());
    EXPECT_EQ(tracers.lost_count(), 0u);
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 4, 0.3);
}

TEST(Tracers, LostOneStaysAndDoesNotCount) {
  auto motion = testing::turning_particles(0, 0.01, {Vec3(0.5, 0, 0)}, 1, 0.3);
  const std::vector<Vec3> start{Vec3(0.6, 0, 0), Vec3(7, 0, 0)};
  MaterialTracers tracers(start);
  tracers.step(motion);
  EXPECT_EQ(tracers.lost_count(), 1u);
  EXPECT_EQ(tracers.position()[1], start[1]);
  EXPECT_GT((tracers.position()[0] - start[0]).norm(), 0.01);
  TriangleMesh mesh = make_triangle_mesh({tracers.position()[0] + Vec3(0.3, 0, 0), Vec3(99, 0, 0)}, {});
  EXPECT_NEAR(tracer_distance(mesh, tracers, 2).value(), 0.15, 1e-12);
  mesh.position.emplace_back(50, 50, 50);
  mesh.id.push_back(mesh.next_id++);
  EXPECT_NEAR(tracer_distance(mesh, tracers, 2).value(), 0.15, 1e-12) << "a later vertex has no tracer";

  MaterialTracers all_lost(std::span<const Vec3>(start).subspan(1));
  all_lost.step(motion);
  EXPECT_FALSE(tracer_distance(make_triangle_mesh({start[1]}, {}), all_lost, 1).has_value());
}

TEST(Tracers, OfVerticesThatAreGoneDoNotCount) {
  const std::vector<Vec3> start{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0)};
  const MaterialTracers tracers(start);
  TriangleMesh mesh = make_triangle_mesh({Vec3(0, 1, 0), Vec3(2, 3, 0)}, {});
  mesh.id = {0, 2};
  mesh.next_id = 3;
  EXPECT_NEAR(tracer_distance(mesh, tracers, 1).value(), 2, 1e-12);
  mesh.id = {3, 4};
  EXPECT_FALSE(tracer_distance(mesh, tracers, 1).has_value());
}

}  // namespace
}  // namespace kappaflow
