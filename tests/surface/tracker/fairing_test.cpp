#include "surface/tracker/fairing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::TorusField;

EllipsoidField sphere(double radius) {
  return {Vec3::Zero(), Mat3::Identity(), Vec3::Constant(radius)};
}

ParticleField lone_particle() {
  return ParticleField(testing::rotating_particles({Vec3::Zero()}, 1, 1), 0.3, 0);
}

double largest_distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  double largest = 0;
  for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, (a[v] - b[v]).norm());
  return largest;
}

TEST(Projection, ConvergesQuadratically) {
  const EllipsoidField field(Vec3(1, 2, 3), testing::rotation(Vec3(0.3, 0.5, -1)), Vec3(1, 0.7, 0.5));
  const Vec3 start = Vec3(1, 2, 3) + Vec3(0.45, 0.3, 0.32);
  std::vector<double> residual;
  for (int iterations = 0; iterations < 4; ++iterations) {
    // The tolerance is never met: the residual after each iteration is taken from where a looser one would
    // stop.
    double tolerance = 1;
    Projected projected = project(field, start, {.tolerance = tolerance});
    for (int i = 0; i < iterations; ++i) {
      tolerance = 0.999 * projected.residual;
      projected = project(field, start, {.tolerance = tolerance});
    }
    ASSERT_TRUE(projected.converged);
    residual.push_back(projected.residual);
  }
  for (int i = 0; i < 3; ++i) EXPECT_LT(residual[i + 1], 2 * residual[i] * residual[i]) << i;
  EXPECT_LT(residual[3], 1e-6);
}

TEST(Projection, ReachesTheSurfaceFromBothSidesAndReportsTheGradient) {
  const ParticleField field = lone_particle();
  const double radius = std::sqrt(1 - std::cbrt(0.3));
  for (const double from : {0.1, 0.4, 0.7, 0.9}) {
    const Vec3 x = from * Vec3(1, -2, 2) / 3;
    const Projected projected = project(field, x, {.tolerance = 1e-12});
    ASSERT_TRUE(projected.converged) << from;
    EXPECT_NEAR(projected.position.norm(), radius, 1e-11);
    EXPECT_LE(projected.residual, 1e-12);
    EXPECT_LT((projected.position.normalized() - x.normalized()).norm(), 1e-12);
    EXPECT_EQ(projected.gradient, field.value_and_gradient(projected.position).g);
  }
}

TEST(Projection, LeavesPointsOnTheSurfaceAlone) {
  const EllipsoidField field = sphere(1);
  const Vec3 x(0, 0, 1 + 5e-5);
  EXPECT_EQ(project(field, x, {.tolerance = 1e-4}).position, x);
  EXPECT_TRUE(project(field, x, {.tolerance = 1e-4}).converged);
}

TEST(Projection, NeverGoesFurtherThanTheReach) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(-2.5, 2.5);
  const ParticleField field = testing::random_blobs(2, 30, 1.5);
  int converged = 0, failed = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x(along(random), along(random), along(random));
    const Projected projected = project(field, x, {.tolerance = 1e-6, .reach = 0.5});
    EXPECT_LE((projected.position - x).norm(), 0.5);
    if (projected.converged) {
      const ValueAndGradient at = field.value_and_gradient(projected.position);
      EXPECT_LE(std::abs(at.f) / at.g.norm(), 1e-6);
      EXPECT_LE(projected.residual, 1e-6);
    } else {
      EXPECT_EQ(projected.position, x);
    }
    ++(projected.converged ? converged : failed);
  }
  EXPECT_GT(converged, 300);
  EXPECT_GT(failed, 300);
}

TEST(Projection, FailsCleanlyWhereThereIsNoGradient) {
  const ParticleField field = lone_particle();
  for (const Vec3& x : {Vec3(3, 0, 0), Vec3(0, 0, 0), Vec3(std::nan(""), 0, 0), Vec3(0, HUGE_VAL, 0)}) {
    const Projected projected = project(field, x, {});
    EXPECT_FALSE(projected.converged) << x.transpose();
    EXPECT_TRUE((projected.position.array() == x.array() || x.array().isNaN()).all());
    EXPECT_GT(projected.residual, 0.1);
  }
}

TEST(Projection, FailsWhereTheFieldHasALocalMaximumBelowZero) {
  const ParticleField below(testing::rotating_particles({Vec3::Zero()}, 1, 1), 1.2, 0);
  for (const double x : {0.05, 0.2, 0.5, 0.8}) EXPECT_FALSE(project(below, Vec3(x, 0, 0), {}).converged) << x;
}

TEST(Projection, AllFlagsFailuresAndReturnsTheLargestResidual) {
  const ParticleField field = lone_particle();
  std::vector<Vec3> position{Vec3(0.5, 0, 0), Vec3(5, 0, 0), Vec3(0, 0.7, 0)};
  std::vector<char> unprojected(3, 7);
  const double residual = project_all(field, {}, position, unprojected);
  EXPECT_EQ(unprojected, (std::vector<char>{0, 1, 0}));
  EXPECT_EQ(position[1], Vec3(5, 0, 0));
  EXPECT_GT(residual, 0);
  EXPECT_LE(residual, ProjectionOptions{}.tolerance);
}

TEST(InitialMesh, HasWellShapedTriangles) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const ParticleField field = testing::random_blobs(seed, 60, 1.6);
    const TriangleMesh raw = extract_isosurface(field, 0.2), mesh = initial_mesh(field, 0.2, {});
    const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles),
                       of_raw = mesh_topology(raw.position, raw.triangles);
    EXPECT_EQ(topology.components, of_raw.components);
    EXPECT_EQ(topology.genus, of_raw.genus);
    const QualityRange quality = triangle_qualities(mesh.position, mesh.triangles);
    EXPECT_GT(quality.min, 0.2) << seed;
    EXPECT_GT(quality.mean, 0.9) << seed;
    EXPECT_EQ(std::ranges::count(mesh.unprojected, 1), 0);
    EXPECT_EQ(mesh.rest_position, mesh.position);
    for (const Vec3& x : mesh.position) {
      const ValueAndGradient at = field.value_and_gradient(x);
      EXPECT_LE(std::abs(at.f) / at.g.norm(), ProjectionOptions{}.tolerance);
    }
  }
}

TEST(InitialMesh, EmptyWhereThereIsNoSurface) {
  const ParticleField below(testing::rotating_particles({Vec3::Zero()}, 1, 1), 1.5, 0);
  EXPECT_EQ(initial_mesh(below, 0.2, {}).vertex_count(), 0u);
}

/// What a tracker's step does after its advection.
double project_and_fair(const Field& field, const VertexRings& rings, const FairingOptions& options,
                        const ProjectionOptions& projection, double dt, TriangleMesh& mesh,
                        FairingState& state) {
  project_all(field, projection, mesh.position, mesh.unprojected, mesh.gradient);
  return fair(field, rings, options, projection, dt, mesh, state);
}

/// A sphere's mesh whose vertices have been displaced along the surface.
TriangleMesh distorted(const TriangleMesh& mesh, const Field& field, double size) {
  TriangleMesh moved = mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-size, size);
  for (Vec3& x : moved.position)
    x = project(field, x + Vec3(along(random), along(random), along(random)), {.tolerance = 1e-8}).position;
  return moved;
}

TEST(Fairing, MeshAtRestStaysAsItIs) {
  const TorusField field(1, 0.45);
  TriangleMesh mesh = initial_mesh(field, 0.15, {});
  const std::vector<Vec3> before = mesh.position;
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  FairingState state = fairing_state(mesh, rings);
  project_and_fair(field, rings, {.iterations = 20}, {}, 0.1, mesh, state);
  EXPECT_EQ(mesh.position, before);
}

TEST(Fairing, EvensOutADistortedMeshOnTheSurface) {
  const EllipsoidField field = sphere(1);
  const TriangleMesh good = initial_mesh(field, 0.15, {.tolerance = 1e-8});
  const VertexRings rings = vertex_rings(good.vertex_count(), good.triangles);
  TriangleMesh mesh = distorted(good, field, 0.06);
  const QualityRange bad = triangle_qualities(mesh.position, mesh.triangles);
  FairingState state = fairing_state(good, rings);
  const double residual =
      project_and_fair(field, rings, {.iterations = 40}, {.tolerance = 1e-8}, 0, mesh, state);
  const QualityRange faired = triangle_qualities(mesh.position, mesh.triangles);
  const QualityRange best = triangle_qualities(good.position, good.triangles);
  EXPECT_LT(bad.mean, best.mean - 0.1);
  EXPECT_GT(faired.mean, best.mean - 0.02);
  EXPECT_GT(faired.min, best.min - 0.1);
  EXPECT_LE(residual, 1e-8);
  for (const Vec3& x : mesh.position) EXPECT_NEAR(x.norm(), 1, 2e-8);
}

// A mobility that is too small to move anything makes fairing look at every vertex: the result is the same.
TEST(Fairing, VerticesWithoutMobilityNeedNotBeLookedAt) {
  const EllipsoidField field = sphere(1);
  const TriangleMesh good = initial_mesh(field, 0.2, {});
  const VertexRings rings = vertex_rings(good.vertex_count(), good.triangles);
  const auto faired = [&](double least) {
    TriangleMesh mesh = distorted(good, field, 0.05);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.mobility[v] = v % 17 == 0 ? 0.8 : least;
    FairingState state = fairing_state(good, rings);
    project_and_fair(field, rings, {.iterations = 5}, {}, 0.1, mesh, state);
    EXPECT_EQ(state.moving.size() < mesh.vertex_count(), least == 0);
    return mesh;
  };
  const TriangleMesh some = faired(0), all = faired(1e-200), start = distorted(good, field, 0.05);
  EXPECT_EQ(some.position, all.position);
  EXPECT_EQ(some.gradient, all.gradient);
  EXPECT_NE(some.position[17], start.position[17]);
}

TEST(Fairing, OrderOfTheVerticesDoesNotMatter) {
  const EllipsoidField field = sphere(1);
  const TriangleMesh good = initial_mesh(field, 0.3, {});
  const TriangleMesh start = distorted(good, field, 0.1);
  std::vector<int> order(good.vertex_count());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));

  const auto faired = [&](const std::vector<int>& index) {  // vertex v becomes vertex index[v]
    TriangleMesh rest = good, mesh = start;
    for (std::size_t v = 0; v < index.size(); ++v) {
      rest.position[index[v]] = good.position[v];
      mesh.position[index[v]] = start.position[v];
    }
    for (Triangle& t : mesh.triangles)
      for (int& v : t) v = index[v];
    rest.triangles = mesh.triangles;
    const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
    FairingState state = fairing_state(rest, rings);
    project_and_fair(field, rings, {.iterations = 5}, {.tolerance = 1e-10}, 0.1, mesh, state);
    std::vector<Vec3> position(index.size());
    for (std::size_t v = 0; v < index.size(); ++v) position[v] = mesh.position[index[v]];
    return position;
  };
  std::vector<int> identity(order.size());
  std::iota(identity.begin(), identity.end(), 0);
  EXPECT_LT(largest_distance(faired(identity), faired(order)), 1e-12);
  EXPECT_GT(largest_distance(faired(identity), start.position), 0.02);
}

TEST(Fairing, RestLengthsRelaxExponentially) {
  const EllipsoidField field = sphere(1);
  TriangleMesh mesh = initial_mesh(field, 0.3, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  FairingState state = fairing_state(mesh, rings);
  const std::vector<double> length = state.rest_length;
  for (double& rest : state.rest_length) rest *= 1.5;
  project_and_fair(field, rings, {.iterations = 0, .rest_length_time = 0.2}, {}, 0.1, mesh, state);
  for (std::size_t k = 0; k < length.size(); ++k)
    EXPECT_NEAR(state.rest_length[k], length[k] * (1 + 0.5 * std::exp(-0.5)), 1e-12);
}

int folded_triangles(const TriangleMesh& mesh, const Field& field) {
  return static_cast<int>(std::ranges::count_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
    return (b - a).cross(c - a).dot(field.value_and_gradient((a + b + c) / 3).g) > 0;
  }));
}

TEST(Fairing, UnfoldsTrianglesWhoseEdgesHaveTheirRestLengths) {
  const EllipsoidField field = sphere(1);
  TriangleMesh mesh = initial_mesh(field, 0.2, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const int neighbour = rings.of(0)[0];
  mesh.position[0] = project(field, 2 * mesh.position[neighbour] - mesh.position[0], {}).position;
  ASSERT_GT(folded_triangles(mesh, field), 0);
  FairingState state = fairing_state(mesh, rings);
  project_and_fair(field, rings, {.iterations = 20}, {}, 0, mesh, state);
  EXPECT_EQ(folded_triangles(mesh, field), 0);
}

TEST(Fairing, LostVertexIsPulledBackByItsNeighbours) {
  const ParticleField field = lone_particle();
  TriangleMesh mesh = initial_mesh(field, 0.2, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  FairingState state = fairing_state(mesh, rings);
  mesh.position[0] *= 4;
  project_and_fair(field, rings, {.iterations = 0}, {}, 0.1, mesh, state);
  EXPECT_EQ(mesh.unprojected[0], 1);
  EXPECT_EQ(std::ranges::count(mesh.unprojected, 1), 1);
  project_and_fair(field, rings, {.iterations = 10}, {}, 0.1, mesh, state);
  EXPECT_EQ(std::ranges::count(mesh.unprojected, 1), 0);
}

}  // namespace
}  // namespace kappaflow
