#include "surface/measure/surface_metrics.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "surface/field/particle_motion.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"

namespace kappaflow {
namespace {

constexpr double kThreshold = 0.125;  // of one particle: (1 - r^2)^3 = 1/8 at r^2 = 1/2

// One particle of sigma 1 at the origin that moves along x: its surface is a sphere.
std::shared_ptr<const Field> one_particle() {
  const Particles particles{0, {0}, {Vec3::Zero()}, {Vec3(2, 0, 0)}};
  return particle_field(particles, {1, WeightRule::uniform, kThreshold});
}
const double kRadius = std::sqrt(0.5);
const double kVolume = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);

TEST(SurfaceMetrics, SphereOfOneParticle) {
  const auto field = one_particle();
  const TriangleMesh mesh = initial_mesh(*field, 0.1, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const SurfaceState state = surface_state(*field, mesh, rings, velocity_method("normal").evaluate, {});
  const SurfaceMetrics metrics = surface_metrics(*field, mesh, state, Vec3(0, 0, 1));
  const SurfaceJudgement judgement = judge_surface(*field, fresh_isosurface(*field, 1).mesh, mesh);
  EXPECT_EQ(metrics.vertices, mesh.vertex_count());
  EXPECT_EQ(metrics.triangles, mesh.triangles.size());
  EXPECT_EQ(metrics.topology.components, 1);
  EXPECT_EQ(metrics.topology.genus, 0);
  EXPECT_EQ(metrics.unprojected, 0u);
  EXPECT_LE(metrics.residual_max, ProjectionOptions().tolerance);
  EXPECT_NEAR(metrics.size.volume, kVolume, 0.02 * kVolume);  // chords: O((edge/R)^2)
  // The normal velocity alone lacks the whole tangential motion, and turns nothing.
  ASSERT_TRUE(metrics.slip.has_value());
  EXPECT_NEAR(*metrics.slip, 1, 1e-6);
  EXPECT_FALSE(metrics.rotation_captured.has_value()) << "a translation has no rotation to capture";
  EXPECT_EQ(metrics.angles_outside, 0);
  EXPECT_EQ(judgement.self_intersections, 0u);
  EXPECT_EQ(judgement.on_lattice.components, 1);
  EXPECT_EQ(judgement.on_lattice.genus, 0);
  EXPECT_EQ(metrics.texture.cracks, 0);
  // The chords of both meshes: h^2 / (6 R) at the middle of a triangle of edge h, and more at longer edges.
  EXPECT_LT(judgement.surface_without_mesh, 0.01);
  EXPECT_LT(judgement.mesh_without_surface, 0.01);
  EXPECT_GT(judgement.mesh_without_surface, 0.001);
}

TEST(SurfaceMetrics, ResidualIsTheDistanceInSigma) {
  const auto field = one_particle();
  TriangleMesh mesh = initial_mesh(*field, 0.2, {});
  mesh.position[3] *= 1 + 1e-3;
  EXPECT_NEAR(surface_residual(*field, mesh), 1e-3 * kRadius, 1e-3 * 1e-3 + 1e-4);
  mesh.unprojected[3] = 1;
  EXPECT_LE(surface_residual(*field, mesh), ProjectionOptions().tolerance) << "flagged vertices do not count";
}

TEST(SurfaceMetrics, FreshIsosurface) {
  const IsosurfaceMetrics metrics = fresh_isosurface(*one_particle(), 1).metrics;
  EXPECT_NEAR(metrics.volume, kVolume, 0.06 * kVolume);  // at 0.25 sigma
  EXPECT_EQ(metrics.topology.components, 1);
  EXPECT_EQ(metrics.topology.genus, 0);
}

TEST(SurfaceMetrics, ParticlesWithoutASurfaceAreOutside) {
  // In a cube of particles one apart the sum is above 2.6 at all of them; alone it is 1, of two 1.99.
  const auto outside = [](double threshold, bool is_normalised) {
    Particles particles;
    for (int n = 0; n < 125; ++n) particles.position.emplace_back(n % 5, n / 5 % 5, n / 25);
    for (const double x : {20.0, 30.0, 40.0, 40.1}) particles.position.emplace_back(x, 0, 0);
    particles.velocity.assign(particles.position.size(), Vec3::Zero());
    particles.id.resize(particles.position.size());
    std::iota(particles.id.begin(), particles.id.end(), 0);
    ParticleFieldOptions options{.sigma = 2, .threshold = threshold};
    if (is_normalised) options.weights = WeightRule::normalised;
    return points_outside(*particle_field(particles, options), particles.position);
  };
  EXPECT_EQ(outside(2.6, false), 4u);
  EXPECT_EQ(outside(1.5, false), 2u);
  EXPECT_EQ(outside(0.5, true), 0u) << "each has one of its own";
}

}  // namespace
}  // namespace kappaflow
