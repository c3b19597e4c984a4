#include "surface/measure/material_tracers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "surface/remesh/initial_mesh.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/tracker/moving_ellipsoid.h"

namespace kappaflow {
namespace {

using testing::moved_with_ellipsoid;
using testing::moving_ellipsoid;

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
