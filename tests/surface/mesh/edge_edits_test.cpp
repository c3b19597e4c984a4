#include "surface/mesh/edge_edits.h"

#include <gtest/gtest.h>

#include <random>

#include "core/errors.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/mesh/closed_meshes.h"

namespace kappaflow {
namespace {

using testing::has_single_fans;
using testing::tetrahedra;

TEST(EdgeEdits, RefuseToBreakATetrahedron) {
  TriangleMesh mesh = tetrahedra(1);
  const std::vector<Triangle> before = mesh.triangles;
  EdgeEdits edits;
  edits.start(mesh);
  for (int h = 0; h < edits.half_edges(); ++h) {
    EXPECT_FALSE(edits.can_collapse(h));
    EXPECT_FALSE(edits.flip(h));
  }
  const int h = edits.find(0, 1);
  EXPECT_EQ(edits.apex(h), 3);
  EXPECT_EQ(edits.apex(edits.twin(h)), 2);
  edits.finish();
  EXPECT_EQ(mesh.triangles, before);
}

TEST(EdgeEdits, RefuseAMeshThatIsNotClosed) {
  TriangleMesh mesh = tetrahedra(1);
  mesh.triangles.pop_back();
  EdgeEdits edits;
  EXPECT_THROW(edits.start(mesh), TopologyError);
}

TEST(EdgeEdits, SplitBlendsAttributes) {
  TriangleMesh mesh = tetrahedra(2);
  for (std::size_t v = 0; v < 8; ++v) mesh.rest_position[v] = Vec3(static_cast<double>(v), 0, 0);
  mesh.source = {10, 11, 12, 13, 14, 15, 16, 17};
  EdgeEdits edits;
  edits.start(mesh);
  const int m = edits.split(edits.find(1, 2), 0.25, Vec3(7, 8, 9));
  EXPECT_EQ(edits.valence(m), 4);
  edits.finish();
  EXPECT_EQ(mesh.position[8], Vec3(7, 8, 9));
  EXPECT_EQ(mesh.rest_position[8], Vec3(1.25, 0, 0));
  EXPECT_EQ(mesh.source, (std::vector<int>{10, 11, 12, 13, 14, 15, 16, 17, 11})) << "names have no mean";
  EXPECT_EQ(mesh.id[8], 8);
  EXPECT_EQ(mesh.next_id, 9);
  EXPECT_EQ(mesh.triangles.size(), 10u);
  EXPECT_TRUE(has_single_fans(mesh));
}

TEST(EdgeEdits, SplitTrianglesBlendAttributesToo) {
  TriangleMesh mesh = make_triangle_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const TriangleMesh before = mesh;
  EdgeEdits edits;
  edits.start(mesh);
  const int m = edits.split(2, {{1, 2, 3}, {0.5, 0.25, 0.25}}, Vec3(7, 8, 9));
  EXPECT_EQ(edits.valence(m), 3);
  for (const int v : {1, 2, 3}) EXPECT_EQ(edits.valence(v), 4);
  EXPECT_EQ(edits.valence(0), 3);
  edits.finish();
  EXPECT_EQ(mesh.position[m], Vec3(7, 8, 9));
  EXPECT_EQ(mesh.rest_position[m], Vec3(0.5, 0.25, 0.25));
  EXPECT_EQ(mesh.triangles.size(), 6u);
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).genus, 0);
  for (std::size_t v = 0; v < 4; ++v) EXPECT_EQ(mesh.position[v], before.position[v]);
}

TEST(EdgeEdits, NewVerticesAreOfTheSourceOfTheNearerParent) {
  TriangleMesh mesh = tetrahedra(1);
  mesh.source = {10, 11, 12, 13};
  EdgeEdits edits;
  edits.start(mesh);
  const auto split_source = [&](int u, int v, double share) {
    return mesh.source[edits.split(edits.find(u, v), share, Vec3::Zero())];
  };
  EXPECT_EQ(split_source(0, 1, 0.75), 11);
  EXPECT_EQ(split_source(2, 3, 0.5), 12) << "of equals the first";
  EXPECT_EQ(split_source(1, 2, 0.25), 11);
  const auto replaced_source = [&](const std::array<double, 3>& weight) {
    return mesh.source[edits.replace(3, {{1, 2, 0}, weight}, Vec3::Zero())];
  };
  EXPECT_EQ(replaced_source({0.3, 0.3, 0.4}), 10);
  edits.finish();
  EXPECT_EQ(mesh.source, (std::vector<int>{10, 11, 12, 11, 12, 11, 10})) << "13 is replaced";
}

TEST(EdgeEdits, TheHeaviestOfEqualsIsTheFirst) {
  EXPECT_EQ(heaviest({{5, 6, 7}, {0.2, 0.4, 0.4}}), 6);
  EXPECT_EQ(heaviest({{5, 6, 7}, {1.0 / 3, 1.0 / 3, 1.0 / 3}}), 5);
  EXPECT_EQ(heaviest({{5, 6, 7}, {0, 0, 1}}), 7);
}

/// A random edit; whether one was made.
bool random_edit(EdgeEdits& edits, const TriangleMesh& mesh, std::mt19937& random) {
  const int h = static_cast<int>(random() % edits.half_edges());
  if (edits.is_removed(h)) return false;
  const int u = edits.origin(h), v = edits.end(h);
  const Vec3 midpoint = 0.5 * (mesh.position[u] + mesh.position[v]);
  switch (random() % 5) {
    case 0:
      edits.split(h, 0.5, midpoint);
      return true;
    case 1:
      edits.replace(u, {{u, v, edits.apex(h)}, {0.5, 0.25, 0.25}}, midpoint);
      return true;
    case 2:
      return edits.flip(h);
    default:
      if (!edits.can_collapse(h)) return false;
      edits.collapse(h);
      return true;
  }
}

TEST(EdgeEdits, RandomEditsKeepTheMeshClosedAndManifoldAndVerticesThemselves) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    TriangleMesh mesh = extract_isosurface(testing::random_blobs(seed, 50, 1.5), 0.35);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.source[v] = static_cast<int>(v % 3);
    const TriangleMesh start = mesh;
    const MeshTopology before = mesh_topology(mesh.position, mesh.triangles);
    std::mt19937 random(seed);
    EdgeEdits edits;
    for (int round = 0; round < 4; ++round) {
      edits.start(mesh);
      int done = 0;
      for (int i = 0; i < 1000; ++i) done += random_edit(edits, mesh, random);
      edits.finish();
      EXPECT_GT(done, 100);
      const MeshTopology after = mesh_topology(mesh.position, mesh.triangles);
      EXPECT_EQ(after.components, before.components);
      EXPECT_EQ(after.genus, before.genus);
      EXPECT_TRUE(has_single_fans(mesh));
      EXPECT_TRUE(std::ranges::is_sorted(mesh.id, std::less_equal{}));
      EXPECT_LT(mesh.id.back(), mesh.next_id);
      const std::size_t old = vertices_older_than(mesh, start.next_id);
      EXPECT_EQ(mesh.source.size(), mesh.vertex_count());
      EXPECT_EQ(std::ranges::count_if(mesh.source, [](int s) { return s < 0 || s > 2; }), 0);
      for (std::size_t v = 0; v < old; ++v) {
        EXPECT_EQ(mesh.position[v], start.position[mesh.id[v]]);
        EXPECT_EQ(mesh.rest_position[v], start.rest_position[mesh.id[v]]);
        EXPECT_EQ(mesh.source[v], start.source[mesh.id[v]]);
      }
    }
  }
}

}  // namespace
}  // namespace kappaflow
