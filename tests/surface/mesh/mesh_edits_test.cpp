#include "surface/mesh/mesh_edits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "core/errors.h"
#include "core/saved_state.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/mesh/closed_meshes.h"

namespace kappaflow {
namespace {

using testing::has_single_fans;
using testing::tetrahedra;

TEST(MeshEdits, RefuseToBreakATetrahedron) {
  TriangleMesh mesh = tetrahedra(1);
  const std::vector<Triangle> before = mesh.triangles;
  MeshEdits edits;
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

TEST(MeshEdits, RefuseAMeshThatIsNotClosed) {
  TriangleMesh mesh = tetrahedra(1);
  mesh.triangles.pop_back();
  MeshEdits edits;
  EXPECT_THROW(edits.start(mesh), TopologyError);
}

TEST(MeshEdits, SplitBlendsAttributes) {
  TriangleMesh mesh = tetrahedra(2);
  for (std::size_t v = 0; v < 8; ++v) mesh.rest_position[v] = Vec3(static_cast<double>(v), 0, 0);
  mesh.source = {10, 11, 12, 13, 14, 15, 16, 17};
  MeshEdits edits;
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

TEST(MeshEdits, SplitTrianglesBlendAttributesToo) {
  TriangleMesh mesh = make_triangle_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                         {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  const TriangleMesh before = mesh;
  MeshEdits edits;
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

TEST(MeshEdits, NewVerticesAreOfTheSourceOfTheNearerParent) {
  TriangleMesh mesh = tetrahedra(1);
  mesh.source = {10, 11, 12, 13};
  MeshEdits edits;
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

TEST(MeshEdits, TheHeaviestOfEqualsIsTheFirst) {
  EXPECT_EQ(heaviest({{5, 6, 7}, {0.2, 0.4, 0.4}}), 6);
  EXPECT_EQ(heaviest({{5, 6, 7}, {1.0 / 3, 1.0 / 3, 1.0 / 3}}), 5);
  EXPECT_EQ(heaviest({{5, 6, 7}, {0, 0, 1}}), 7);
}

/// A random edit; whether one was made.
bool random_edit(MeshEdits& edits, const TriangleMesh& mesh, std::mt19937& random) {
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

/// Refuses what sweeps more than a volume.
class SmallSweeps final : public EditGuard {
 public:
  explicit SmallSweeps(double most) : most_(most) {}
  bool allows(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) const override {
    return std::abs((b - a).cross(c - a).dot(x - a)) / 6 <= most_;
  }

 private:
  double most_;
};

TEST(MeshEdits, TheGuardMayRefuseEachEdit) {
  TriangleMesh mesh = tetrahedra(1);
  const TriangleMesh before = mesh;
  const SmallSweeps guard(1e-3);
  MeshEdits edits;
  edits.start(mesh, &guard);
  const VertexBlend corner{{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(edits.split(edits.find(0, 1), 0.5, Vec3(0.5, -1, -1)), -1);
  EXPECT_EQ(edits.split(0, corner, Vec3(0.2, 0.2, -1)), -1);
  EXPECT_EQ(edits.replace(0, corner, Vec3(-1, -1, -1)), -1);
  edits.finish();
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_EQ(mesh.position, before.position);
  EXPECT_EQ(mesh.next_id, before.next_id);
  edits.start(mesh, &guard);
  const int m = edits.split(edits.find(0, 1), 0.5, Vec3(0.5, 0, 0));  // sweeps nothing
  ASSERT_EQ(m, 4);
  const int n = edits.split(edits.find(0, 2), 0.5, Vec3(0, 0.5, 0));
  ASSERT_EQ(n, 5);
  EXPECT_FALSE(edits.collapse(edits.find(0, 3))) << "the corner would go";
  EXPECT_TRUE(edits.collapse(edits.find(m, 1))) << "nothing is swept";
  edits.finish();
  EXPECT_TRUE(has_single_fans(mesh));
}

TEST(MeshEdits, AnExchangeTakesTrianglesOutAndPutsOthersIn) {
  TriangleMesh mesh = tetrahedra(2);
  mesh.source = {0, 1, 2, 3, 4, 5, 6, 7};
  MeshEdits edits;
  edits.start(mesh);
  const Triangle face = mesh.triangles[3];
  const int tip = edits.try_vertex(Vec3(1, 1, 1), Vec3(0, 0, -1));
  EXPECT_EQ(tip, 8);
  EXPECT_EQ(mesh.id.size(), 8u) << "on trial only";
  const std::vector<Triangle> roof{{face[0], face[1], tip}, {face[1], face[2], tip}, {face[2], face[0], tip}};
  EXPECT_TRUE(edits.misfits(std::array{3}, roof).empty());
  const std::vector<VertexBlend> from{{{face[0], face[1], face[2]}, {0.2, 0.6, 0.2}}};
  ASSERT_TRUE(edits.exchange(std::array{3}, roof, from));
  EXPECT_EQ(edits.valence(tip), 3);
  EXPECT_EQ(edits.valence(face[0]), 4);
  edits.drop_removed_triangles();
  EXPECT_GE(edits.find(tip, face[2]), 0);
  edits.finish();
  EXPECT_EQ(mesh.triangles.size(), 10u);
  EXPECT_TRUE(has_single_fans(mesh));
  EXPECT_EQ(mesh.id[8], 8);
  EXPECT_EQ(mesh.source[8], face[1]);
  EXPECT_EQ(mesh.gradient[8], Vec3(0, 0, -1));
  EXPECT_LT((mesh.rest_position[8] -
             Vec3(0.6 * mesh.position[face[1]] + 0.2 * mesh.position[face[0]] + 0.2 * mesh.position[face[2]]))
                .norm(),
            1e-15);
}

TEST(MeshEdits, AnExchangeIsRefusedUnlessTheMeshStaysClosedAndManifold) {
  TriangleMesh mesh = tetrahedra(2);
  const TriangleMesh before = mesh;
  MeshEdits edits;
  edits.start(mesh);
  const Triangle face = mesh.triangles[3];
  const auto [a, b, c] = face;
  const int tip = edits.try_vertex(Vec3(1, 1, 1), Vec3::Zero());
  const std::array removed{3};
  const auto refused = [&](const std::vector<Triangle>& added) {
    return !edits.misfits(removed, added).empty() && !edits.exchange(removed, added, {});
  };
  EXPECT_TRUE(refused({{a, b, tip}, {b, c, tip}})) << "a hole stays";
  EXPECT_TRUE(refused({{a, c, b}})) << "inside out";
  EXPECT_TRUE(refused({{a, b, c}, {a, b, c}})) << "twice";
  EXPECT_TRUE(refused({{a, b, 4}, {b, c, 4}, {c, a, 4}})) << "touches the other piece in one vertex";
  EXPECT_EQ(edits.misfits(removed, std::vector<Triangle>{{a, b, tip}, {b, c, tip}}), (std::vector{0, 1}));
  EXPECT_FALSE(edits.exchange(removed, {}, {})) << "nothing in its place";
  const std::array two{3, 7};  // of two pieces, one of them filled
  EXPECT_FALSE(edits.exchange(two, std::vector<Triangle>{face}, {})) << "the other hole stays";
  edits.discard_tried();
  EXPECT_TRUE(edits.exchange(removed, std::vector<Triangle>{{b, c, a}}, {})) << "the same turned";
  edits.finish();
  EXPECT_EQ(mesh.position, before.position);
  EXPECT_EQ(mesh.triangles.size(), before.triangles.size());
}

TEST(VertexArrays, EveryEditCarriesThemByTheirRules) {
  TriangleMesh mesh = tetrahedra(3);
  mesh.add_array<double>("height", Carry::interpolate, 0.0);
  mesh.add_array<int>("part", Carry::nearest, -7);
  mesh.add_array<Vec3>("force", Carry::recompute, Vec3(1, 2, 3));
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    mesh.array<double>("height")[v] = mesh.rest_position[v].z();
    mesh.array<int>("part")[v] = static_cast<int>(v) / 4;
    mesh.array<Vec3>("force")[v] = Vec3::Zero();
  }
  std::mt19937 random(3);
  MeshEdits edits;
  edits.start(mesh);
  for (int n = 0; n < 300; ++n) random_edit(edits, mesh, random);
  edits.finish();
  const TriangleMesh& edited = mesh;
  for (std::size_t v = 0; v < edited.vertex_count(); ++v) {
    EXPECT_NEAR(edited.array<double>("height")[v], edited.rest_position[v].z(), 1e-12);
    EXPECT_EQ(edited.array<int>("part")[v], std::lround(std::floor((edited.rest_position[v].x() + 1) / 3)));
    EXPECT_EQ(edited.array<Vec3>("force")[v], edited.id[v] < 12 ? Vec3(0, 0, 0) : Vec3(1, 2, 3));
  }
}

TEST(VertexArrays, WrongNamesAndRulesAreRefused) {
  TriangleMesh mesh = tetrahedra(1);
  mesh.add_array<double>("heat", Carry::interpolate, 2.5);
  EXPECT_EQ(mesh.array<double>("heat")[3], 2.5);
  EXPECT_THROW(mesh.add_array<int>("heat", Carry::nearest, 0), InvalidInput);
  EXPECT_THROW(mesh.add_array<Vec3>("rest_position", Carry::nearest, Vec3::Zero()), InvalidInput);
  EXPECT_THROW(mesh.add_array<int>("part", Carry::interpolate, 0), InvalidInput);
  EXPECT_THROW(mesh.array<double>("cold"), InvalidInput);
  EXPECT_THROW(mesh.array<int>("heat"), InvalidInput);
}

TEST(VertexArrays, AreSavedWithTheMesh) {
  TriangleMesh mesh = tetrahedra(2), read;
  mesh.add_array<double>("heat", Carry::interpolate, 2.5)[5] = 7;
  mesh.mobility[1] = 0.25;
  std::stringstream bytes;
  StateWriter writer(bytes, little_endian());
  writer(mesh);
  StateReader reader(bytes);
  reader(read);
  EXPECT_EQ(read.array<double>("heat")[5], 7);
  EXPECT_EQ(read.mobility, mesh.mobility);
  EXPECT_EQ(read.id, mesh.id);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(MeshEdits, RandomEditsKeepTheMeshClosedAndManifoldAndVerticesThemselves) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    TriangleMesh mesh = extract_isosurface(testing::random_blobs(seed, 50, 1.5), 0.35);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.source[v] = static_cast<int>(v % 3);
    const TriangleMesh start = mesh;
    const MeshTopology before = mesh_topology(mesh.position, mesh.triangles);
    std::mt19937 random(seed);
    MeshEdits edits;
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

/// The triangles around a vertex, each from it on.
std::vector<Triangle> fan_of(const MeshEdits& edits, int v) {
  std::vector<Triangle> fan;
  if (edits.is_alive(v))
    edits.for_each_out(v, [&](int h) { fan.push_back({v, edits.end(h), edits.apex(h)}); });
  return fan;
}

TEST(MeshEdits, TellAroundWhichVerticesNothingHasChanged) {
  TriangleMesh mesh = extract_isosurface(testing::random_blobs(1, 50, 1.5), 0.35);
  std::mt19937 random(1);
  MeshEdits edits;
  edits.start(mesh);
  for (int round = 0; round < 100; ++round) {
    const std::uint32_t made = edits.made();
    std::vector<std::vector<Triangle>> before;
    for (int v = 0; v < static_cast<int>(mesh.vertex_count()); ++v) before.push_back(fan_of(edits, v));
    int done = 0;
    while (done < 3) done += random_edit(edits, mesh, random);
    std::size_t unchanged = 0;
    for (int v = 0; v < static_cast<int>(before.size()); ++v) {
      const bool same = fan_of(edits, v) == before[v];
      if (edits.is_as_it_was(v, 0, made)) {
        EXPECT_TRUE(same);
        ++unchanged;
      }
      EXPECT_EQ(edits.is_as_it_was(v, 1, made),
                edits.is_as_it_was(v, 0, made) && std::ranges::all_of(before[v], [&](const Triangle& t) {
                  return edits.is_as_it_was(t[1], 0, made);
                }));
    }
    EXPECT_GT(unchanged, before.size() / 2) << "three edits touch few";
  }
  edits.finish();
}

}  // namespace
}  // namespace kappaflow
