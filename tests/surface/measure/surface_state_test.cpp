#include "surface/measure/surface_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/field/particle_field.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::TorusField;

constexpr double kPi = std::numbers::pi;

EllipsoidField sphere(double radius) {
  return {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(radius)};
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

}  // namespace
}  // namespace kappaflow
