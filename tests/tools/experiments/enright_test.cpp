// The tracker on Enright's test, where the motion of the material is known.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "surface/field/runge_kutta.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/remesh/mesh_in_order.h"
#include "tools/experiments/enright_flow.h"

namespace kappaflow {
namespace {

constexpr VelocityOptions kExact{.damping = 1e-3, .speed_limit = 4};

/// The vertices of the mesh after `steps` steps to time t without projection: the velocities alone.
std::vector<Vec3> advected(const TriangleMesh& mesh, const char* method, double t, int steps) {
  const std::vector<double> area(mesh.vertex_count(), 0.0);
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  std::vector<Vec3> points = mesh.position;
  SurfaceVelocities velocities;
  RungeKutta runge_kutta;
  for (int n = 0; n < steps; ++n) {
    EnrightMotion motion(t * n / steps, t * (n + 1) / steps);
    runge_kutta.advance(
        motion, TimeIntegrator::rk4, points,
        [&](const Field& field, std::span<const Vec3> x) -> std::span<const Vec3> {
          velocity_method(method).evaluate(field, {x, area, rings}, kExact, velocities.sized(x.size()));
          return velocities.velocity;
        });
  }
  return points;
}

TEST(Enright, VelocitiesKeepThePointsOnTheSurface) {
  constexpr double t = 0.06;
  const TriangleMesh mesh = initial_mesh(EnrightField(0), 0.05, {.tolerance = 1e-10});
  for (const char* method : {"normal", "total", "curvature", "material"}) {
    const std::vector<Vec3> points = advected(mesh, method, t, 6);
    double moved = 0, off_surface = 0;
    for (std::size_t v = 0; v < points.size(); ++v) {
      const ValueAndGradient at = EnrightField(t).value_and_gradient(points[v]);
      off_surface = std::max(off_surface, std::abs(at.f) / at.g.norm());
      moved = std::max(moved, (points[v] - mesh.position[v]).norm());
    }
    EXPECT_GT(moved, 0.05) << method;
    EXPECT_LT(off_surface, 1e-6) << method;
  }
}

TEST(Enright, MaterialFollowsTheFlowMapWithFourthOrder) {
  constexpr double t = 0.4;
  const TriangleMesh mesh = initial_mesh(EnrightField(0), 0.05, {.tolerance = 1e-10});
  std::vector<Vec3> exact = mesh.position;
  carry<EnrightFlow>(exact, 0, t);
  std::vector<double> error;
  for (const int steps : {20, 40}) {
    const std::vector<Vec3> points = advected(mesh, "material", t, steps);
    double sum = 0;
    for (std::size_t v = 0; v < points.size(); ++v) sum += (points[v] - exact[v]).squaredNorm();
    error.push_back(std::sqrt(sum / static_cast<double>(points.size())));
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 4, 0.3);
  EXPECT_LT(error[1], 1e-6);
}

TEST(Enright, TrackerFollowsItWithTheSameBitsForAnyNumberOfThreads) {
  for (const char* method : {"total", "curvature", "material"}) {
    std::vector<std::vector<Vec3>> result;
    for (const std::size_t threads : {1, 3}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      SurfaceTracker tracker(initial_mesh(EnrightField(0), 0.06, {}),
                             {.method = velocity_method(method).evaluate,
                              .integrator = TimeIntegrator::rk4,
                              .velocity = kExact,
                              .fairing = {.iterations = 0}});
      for (int n = 0; n < 3; ++n) {
        EnrightMotion motion(0.05 * n, 0.05 * (n + 1));
        const TrackerStep step = tracker.step(motion);
        EXPECT_EQ(step.unprojected, 0u) << method;
        EXPECT_LE(step.residual_max, ProjectionOptions{}.tolerance);
      }
      result.push_back(tracker.mesh().position);
    }
    EXPECT_EQ(result[0], result[1]) << method;
  }
}

TEST(Enright, RemeshingKeepsAStretchedSheetInOrderAndBringsItBack) {
  // Half of the stretch that the test has at its half time, and back.
  constexpr int kSteps = 24;
  constexpr double kTurn = 0.8;
  const TrackerOptions options{.method = velocity_method("material").evaluate,
                               .integrator = TimeIntegrator::rk4,
                               .fairing = {.iterations = 0},
                               .remeshing = {.edge_length = 0.03, .finest = 0.3}};
  SurfaceTracker tracker(initial_mesh(EnrightField(0), 0.03, {}), options);
  const double volume = area_and_volume(tracker.mesh().position, tracker.mesh().triangles).volume;
  std::size_t splits = 0, collapses = 0, flips = 0;
  for (int n = 0; n < kSteps; ++n) {
    // The flow is steady but for its factor: going back is the time from the mirror image of kTurn on.
    const bool back = n >= kSteps / 2;
    const double dt = 2 * kTurn / kSteps, t = n * dt;
    const double t0 = back ? EnrightFlow::kPeriod - 2 * kTurn + t : t;
    EnrightMotion motion(t0, std::min(t0 + dt, EnrightFlow::kPeriod));
    const TrackerStep step = tracker.step(motion);
    EXPECT_EQ(step.unprojected, 0u);
    splits += step.edits.splits;
    collapses += step.edits.collapses;
    flips += step.edits.flips;
    testing::expect_in_order(*motion.at(motion.t1()), tracker.mesh(), {1, 0});
  }
  EXPECT_GT(splits, 200u);
  EXPECT_GT(collapses, 100u);
  EXPECT_GT(flips, 200u);
  const TriangleMesh& mesh = tracker.mesh();
  EXPECT_NEAR(area_and_volume(mesh.position, mesh.triangles).volume / volume, 1, 2e-3);
  // The map to the first mesh: its error is that of linear interpolation along edges, h^2 / (8 R) once.
  double largest = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    largest = std::max(largest, (mesh.position[v] - mesh.rest_position[v]).norm());
  EXPECT_LT(largest, 0.5 * 0.03);
}

}  // namespace
}  // namespace kappaflow
