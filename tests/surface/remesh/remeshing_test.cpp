// The invariants of remeshing; tests/tools/experiments/enright_test.cpp has them in a flow that stretches a
// surface.
#include "surface/remesh/remeshing.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <numbers>
#include <unordered_map>

#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/fairing.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/remesh/mesh_in_order.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::expect_in_order;

/// What a projection would leave, without moving anything.
void set_gradient(const Field& field, TriangleMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    mesh.gradient[v] = field.value_and_gradient(mesh.position[v]).g;
}

TrackerOptions with_remeshing(const char* method, double edge) {
  return {.method = velocity_method(method).evaluate,
          .integrator = TimeIntegrator::rk4,
          .fairing = {.iterations = 0},
          .remeshing = {.edge_length = edge, .finest = 0.3}};
}

TEST(Remeshing, LeavesAGoodMeshAlone) {
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.8, 0.7));
  TriangleMesh mesh = initial_mesh(field, 0.1, {});
  const std::size_t vertices = mesh.vertex_count();
  const TriangleMesh before = mesh;
  const VertexRings rings = vertex_rings(vertices, mesh.triangles);
  set_gradient(field, mesh);
  Remesher remesher;
  remesher.remesh(field, {.edge_length = 0.1}, {}, rings, mesh);
  EXPECT_GT(static_cast<double>(vertices_older_than(mesh, before.next_id)),
            0.98 * static_cast<double>(vertices));
  expect_in_order(field, mesh, {1, 0});
}

TEST(Remeshing, UntouchedVerticesKeepEveryBit) {
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.8, 0.7));
  TriangleMesh mesh = initial_mesh(field, 0.1, {});
  for (Vec3& x : mesh.rest_position) x = Vec3(x[1], 2 * x[2], -x[0]);
  const TriangleMesh before = mesh;
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  set_gradient(field, mesh);
  std::ranges::transform(mesh.position, mesh.mobility.begin(), [](const Vec3& x) { return x[0]; });
  Remesher remesher;
  const RemeshCounts counts = remesher.remesh(field, {.edge_length = 0.16, .finest = 0.3}, {}, rings, mesh);
  EXPECT_GT(counts.collapses, 100u);
  ASSERT_EQ(mesh.gradient.size(), mesh.vertex_count());
  const std::size_t old = vertices_older_than(mesh, before.next_id);
  EXPECT_LT(old, before.vertex_count());
  for (std::size_t v = 0; v < old; ++v) {
    const auto was = static_cast<std::size_t>(mesh.id[v]);
    EXPECT_EQ(mesh.position[v], before.position[was]);
    EXPECT_EQ(mesh.rest_position[v], before.rest_position[was]);
    EXPECT_EQ(mesh.mobility[v], before.position[was][0]);
  }
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    EXPECT_EQ(mesh.gradient[v], field.value_and_gradient(mesh.position[v]).g);
  expect_in_order(field, mesh, {1, 0});
}

TEST(Remeshing, EdgesFollowTheCurvature) {
  // A long ellipsoid: curvature 1 / 0.04 and more at its tips, 1 / 0.2 at its waist.
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.2, 0.2));
  TriangleMesh mesh = initial_mesh(field, 0.08, {});
  set_gradient(field, mesh);
  Remesher remesher;
  for (int round = 0; round < 12; ++round)
    remesher.remesh(field, {.edge_length = 0.08, .turn = 0.3, .finest = 0.1}, {},
                    vertex_rings(mesh.vertex_count(), mesh.triangles), mesh);
  double tip = 0, tip_count = 0, waist = 0, waist_count = 0;
  for (const Triangle& t : mesh.triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec3 &a = mesh.position[t[c]], &b = mesh.position[t[(c + 1) % 3]];
      if (std::abs(a[0]) > 0.99) tip += (a - b).norm(), ++tip_count;
      if (std::abs(a[0]) < 0.3) waist += (a - b).norm(), ++waist_count;
    }
  // Aimed at: 0.3 x 0.04 at the tip; 0.3 x 0.2 at the waist. Edges lie between 0.6 and 1.5 of that.
  EXPECT_NEAR(tip / tip_count, 0.012, 0.005);
  EXPECT_NEAR(waist / waist_count, 0.06, 0.018);
  expect_in_order(field, mesh, {1, 0});
}

/// The largest distance of a triangle's centroid from f = 0.
double largest_chord(const Field& field, const TriangleMesh& mesh) {
  double largest = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 centroid = (mesh.position[a] + mesh.position[b] + mesh.position[c]) / 3;
    largest = std::max(largest, (project(field, centroid, {}).position - centroid).norm());
  }
  return largest;
}

TEST(Remeshing, TrianglesThatCutThroughARimAreRefined) {
  // A lens an edge thick, with the mesh of a thicker one pressed flat: triangles at its rim have corners on
  // both of its sides.
  constexpr double kEdge = 0.25;
  const Vec3 thick(1, 1, 0.2), thin(1, 1, 0.12);
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), thin);
  TriangleMesh mesh = initial_mesh(EllipsoidField(Vec3::Zero(), Mat3::Identity(), thick), kEdge, {});
  for (Vec3& x : mesh.position) x = x.cwiseQuotient(thick).cwiseProduct(thin);
  project_all(field, {}, mesh.position, mesh.unprojected);
  set_gradient(field, mesh);
  const double before = largest_chord(field, mesh);
  Remesher remesher;
  for (int round = 0; round < 4; ++round)
    remesher.remesh(field, {.edge_length = kEdge}, {}, vertex_rings(mesh.vertex_count(), mesh.triangles),
                    mesh);
  EXPECT_GT(before, 0.25 * kEdge);
  EXPECT_LT(largest_chord(field, mesh), 0.2 * kEdge);
  EXPECT_EQ(self_intersections(mesh.position, mesh.triangles), 0u);
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).genus, 0);
}

TEST(Remeshing, RestLengthsSurviveEditsElsewhere) {
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.8, 0.7));
  TriangleMesh mesh = initial_mesh(field, 0.1, {});
  const VertexRings before = vertex_rings(mesh.vertex_count(), mesh.triangles);
  FairingState state = fairing_state(mesh, before);
  set_gradient(field, mesh);
  for (double& rest : state.rest_length) rest *= 2;
  Remesher remesher;
  remesher.remesh(field, {.edge_length = 0.14, .finest = 0.3}, {}, before, mesh);
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  renew_fairing_state(mesh, remesher.history(), before, rings, state);
  std::size_t kept = 0, born = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (int k = rings.start[v]; k < rings.start[v + 1]; ++k) {
      const int w = rings.neighbour[k];
      const double length = (mesh.position[v] - mesh.position[w]).norm();
      const bool was_there =
          mesh.id[v] < static_cast<std::int64_t>(before.start.size()) - 1 &&
          mesh.id[w] < static_cast<std::int64_t>(before.start.size()) - 1 &&
          std::ranges::binary_search(before.of(static_cast<int>(mesh.id[v])), static_cast<int>(mesh.id[w]));
      EXPECT_NEAR(state.rest_length[k], was_there ? 2 * length : length, 1e-14);
      ++(was_there ? kept : born);
    }
  EXPECT_GT(kept, 500u);
  EXPECT_GT(born, 500u);
}

TEST(Remeshing, SameBitsForAnyNumberOfThreads) {
  std::vector<TriangleMesh> result;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    TrackerOptions options = with_remeshing("curvature", 0.12);
    options.fairing.iterations = 2;
    options.velocity = {.damping = 1e-3, .speed_limit = 4};
    const std::vector<Vec3> start{Vec3(0.5, 0, 0), Vec3(-0.3, 0.4, 0), Vec3(-0.3, -0.4, 0)};
    auto first = testing::turning_particles(0, 0.02, start, 1, 0.3);
    SurfaceTracker tracker(initial_mesh(*first.at(0), 0.15, {}), options);
    RemeshCounts counts = tracker.step(first).edits;
    EXPECT_TRUE(counts.any());
    for (int n = 1; n < 5; ++n) {
      auto motion = testing::turning_particles(0.02 * n, 0.02 * (n + 1), start, 1, 0.3);
      tracker.step(motion);
    }
    result.push_back(tracker.mesh());
  }
  for (const TriangleMesh& other : {result[1], result[2]}) {
    EXPECT_EQ(result[0].position, other.position);
    EXPECT_EQ(result[0].rest_position, other.rest_position);
    EXPECT_EQ(result[0].id, other.id);
    EXPECT_EQ(result[0].triangles, other.triangles);
  }
}

/// A mesh that two remeshings make of this one with so many threads.
TriangleMesh remeshed(const Field& field, TriangleMesh mesh, const RemeshOptions& options, int threads,
                      RemeshCounts& counts) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute([&] {
    Remesher remesher;
    for (int round = 0; round < 2; ++round)
      counts += remesher.remesh(field, options, {}, vertex_rings(mesh.vertex_count(), mesh.triangles), mesh);
  });
  return mesh;
}

/// One thread decides on each edit when it is its turn; several decide ahead, on a mesh that the edits before
/// have yet to change. Where edits are dense that goes wrong for many, unless these are decided anew.
void expect_edits_as_in_one_thread(const Field& field, const TriangleMesh& mesh, const RemeshOptions& options,
                                   RemeshCounts& counts) {
  RemeshCounts ahead;
  const TriangleMesh expected = remeshed(field, mesh, options, 1, counts),
                     result = remeshed(field, mesh, options, 4, ahead);
  EXPECT_EQ(ahead.splits, counts.splits);
  EXPECT_EQ(ahead.collapses, counts.collapses);
  EXPECT_EQ(ahead.flips, counts.flips);
  EXPECT_EQ(ahead.replaced, counts.replaced);
  EXPECT_EQ(result.position, expected.position);
  EXPECT_EQ(result.id, expected.id);
  EXPECT_EQ(result.triangles, expected.triangles);
}

TEST(Remeshing, DenseCollapsesAndRepairsAreDecidedAsInOneThread) {
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.8, 0.7));
  TriangleMesh mesh = initial_mesh(field, 0.06, {});
  for (Vec3& x : mesh.position) {
    const Vec3 shake(std::sin(131 * x[1]), std::sin(157 * x[2]), std::sin(173 * x[0]));
    x += 0.03 * shake;  // makes triangles sharp
  }
  project_all(field, {}, mesh.position, mesh.unprojected);
  set_gradient(field, mesh);
  RemeshCounts coarser, as_fine;
  expect_edits_as_in_one_thread(field, mesh, {.edge_length = 0.09, .finest = 0.3}, coarser);
  EXPECT_GT(coarser.collapses, 1000u);
  expect_edits_as_in_one_thread(field, mesh, {.edge_length = 0.05}, as_fine);
  EXPECT_GT(as_fine.replaced, 30u);
}

TEST(Remeshing, DenseRefinementIsDecidedAsInOneThread) {
  // As above: the mesh of a thick lens pressed flat.
  const Vec3 thick(1, 1, 0.2), thin(1, 1, 0.03);
  const EllipsoidField field(Vec3::Zero(), Mat3::Identity(), thin);
  TriangleMesh mesh = initial_mesh(EllipsoidField(Vec3::Zero(), Mat3::Identity(), thick), 0.15, {});
  for (Vec3& x : mesh.position) x = x.cwiseQuotient(thick).cwiseProduct(thin);
  project_all(field, {}, mesh.position, mesh.unprojected);
  set_gradient(field, mesh);
  RemeshCounts counts;
  expect_edits_as_in_one_thread(field, mesh, {.edge_length = 0.15, .finest = 0.05}, counts);
  EXPECT_GT(counts.splits, 100u);
}

}  // namespace
}  // namespace kappaflow
