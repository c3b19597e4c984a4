#include "surface/mesh/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

struct Sampled {
  TriangleMesh mesh;
  VertexRings rings;
  SurfaceSamples samples;
};

Sampled sampled_blobs(unsigned seed, double mesh_spacing, double spacing) {
  Sampled s{.mesh = extract_isosurface(testing::random_blobs(seed, 12, 1.5), mesh_spacing),
            .rings = {},
            .samples = {}};
  s.rings = vertex_rings(s.mesh.vertex_count(), s.mesh.triangles);
  s.samples = surface_samples(s.mesh.position, s.rings, std::vector<double>(s.mesh.vertex_count(), spacing));
  return s;
}

TEST(SurfaceSamples, PatchesCoverTheMeshOnceAndReachNoFurtherThanTheSpacing) {
  for (const unsigned seed : {1, 2, 3}) {
    const auto [mesh, rings, samples] = sampled_blobs(seed, 0.1, 0.4);
    EXPECT_LT(3 * samples.vertex.size(), mesh.vertex_count());
    std::vector<int> count(mesh.vertex_count(), 0);
    for (std::size_t s = 0; s < samples.vertex.size(); ++s) {
      EXPECT_EQ(samples.of_vertex[samples.vertex[s]], static_cast<int>(s));
      EXPECT_EQ(samples.position[s], mesh.position[samples.vertex[s]]);
      for (const int v : samples.patch(s)) {
        ++count[v];
        EXPECT_EQ(samples.of_vertex[v], static_cast<int>(s));
        EXPECT_LT((mesh.position[v] - samples.position[s]).norm(), 0.4);
      }
    }
    EXPECT_EQ(std::ranges::count(count, 1), static_cast<std::ptrdiff_t>(count.size()));
  }
}

TEST(SurfaceSamples, ThatAreConnectedAlongTheMeshKeepTheirDistance) {
  const auto [mesh, rings, samples] = sampled_blobs(4, 0.1, 0.4);
  SampleWalk walk;
  const SurfaceSamples every_vertex =
      surface_samples(mesh.position, rings, std::vector<double>(mesh.vertex_count(), 0.0));
  for (const int v : samples.vertex)
    for (const int w : walk.around(every_vertex, mesh.position[v], v, 0.25))  // connected in a smaller ball
      EXPECT_TRUE(w == v || samples.vertex[samples.of_vertex[w]] != w);
}

TEST(SurfaceSamples, AreNeighboursWhereTheirPatchesTouch) {
  const auto [mesh, rings, samples] = sampled_blobs(5, 0.1, 0.4);
  std::set<std::pair<int, int>> expected, found;
  for (const Triangle& t : mesh.triangles)
    for (const int v : t)
      for (const int w : t)
        if (samples.of_vertex[v] != samples.of_vertex[w])
          expected.insert({samples.of_vertex[v], samples.of_vertex[w]});
  for (int s = 0; s < static_cast<int>(samples.vertex.size()); ++s)
    for (const int t : samples.rings.of(s)) found.insert({s, t});
  EXPECT_EQ(found, expected);
}

TEST(SurfaceSamples, AreAllVerticesOfACoarseMesh) {
  const auto [mesh, rings, samples] = sampled_blobs(6, 0.2, 1e-4);
  ASSERT_EQ(samples.vertex.size(), mesh.vertex_count());
  EXPECT_EQ(samples.rings.start, rings.start);
  EXPECT_EQ(samples.rings.neighbour, rings.neighbour);
}

/// Everything connected to `start` inside the ball, by a plain flood.
std::set<int> flood(const SurfaceSamples& samples, const Vec3& x, int start, double radius) {
  std::set<int> found{start}, front{start};
  while (!front.empty()) {
    std::set<int> next;
    for (const int s : front)
      for (const int t : samples.rings.of(s))
        if ((samples.position[t] - x).norm() < radius && found.insert(t).second) next.insert(t);
    front = next;
  }
  return found;
}

TEST(SampleWalk, FindsWhatAFloodOfTheBallFindsUnlessThePathIsLong) {
  const auto [mesh, rings, samples] = sampled_blobs(7, 0.1, 0.15);
  SampleWalk walk;
  std::size_t missing = 0, all = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); v += 7) {
    const std::span<const int> found = walk.around(samples, mesh.position[v], samples.of_vertex[v], 0.6);
    const std::set<int> reached(found.begin(), found.end()),
        connected = flood(samples, mesh.position[v], samples.of_vertex[v], 0.6);
    EXPECT_EQ(reached.size(), found.size());
    EXPECT_EQ(found[0], samples.of_vertex[v]);
    EXPECT_TRUE(std::ranges::includes(connected, reached));
    for (const int s : connected)  // nearly straight paths are there: none is missing near the centre
      EXPECT_TRUE(reached.contains(s) || (samples.position[s] - mesh.position[v]).norm() > 0.3);
    missing += connected.size() - reached.size();
    all += connected.size();
  }
  EXPECT_LT(missing, all / 10);
}

TEST(SampleWalk, DoesNotCrossToAnotherPiece) {
  const ParticleField two(testing::rotating_particles({Vec3(0, 0, 0), Vec3(1.4, 0, 0)}, 1, 0), 0.3, 0);
  const TriangleMesh mesh = extract_isosurface(two, 0.1);
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const std::vector<int> piece = vertex_pieces(mesh.vertex_count(), mesh.triangles);
  ASSERT_EQ(*std::ranges::max_element(piece), 1);
  const SurfaceSamples samples =
      surface_samples(mesh.position, rings, std::vector<double>(mesh.vertex_count(), 0.2));
  SampleWalk walk;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (const int s : walk.around(samples, mesh.position[v], samples.of_vertex[v], 1))
      EXPECT_EQ(piece[samples.vertex[s]], piece[v]);
}

}  // namespace
}  // namespace kappaflow
