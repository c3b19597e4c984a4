// Single changes of topology: of meshes and fields that disagree, what is looked at, and what stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "core/solid_distance.h"
#include "surface/mesh/self_intersection.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/topology/topology.h"
#include "surface/topology/winding_numbers.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/topology/components_genus.h"

namespace kappaflow {
namespace {

using testing::ComponentsGenus, testing::topology_of;

constexpr double kEdge = 0.25;  // in sigma

/// A mesh with what a change of topology needs to know of it.
struct Sheet {
  TriangleMesh mesh;

  /// A mesh of one field, projected on another.
  Sheet(const Field& from, const Field& to, double edge) : mesh(initial_mesh(from, edge, {})) {
    std::ranges::fill(mesh.mobility, 0.5);
    project_all(to, {}, mesh.position, mesh.unprojected, mesh.gradient);
  }
  TopologyCounts change(TopologyChange& topology, const Field& field, double edge) {
    return topology.change(field, {.follows_field = true}, edge, {}, Comparison::thorough, mesh);
  }
};

ParticleField two_drops(double apart) {
  return {testing::rotating_particles({Vec3(-0.5 * apart, 0, 0), Vec3(0.5 * apart, 0, 0)}, 1.0, 0.0), 0.3, 0};
}

TEST(Topology, LeavesAMeshThatAgreesAlone) {
  for (const double apart : {1.15, 2.0}) {
    const ParticleField field = two_drops(apart);
    Sheet sheet(field, field, 0.15);
    const TriangleMesh before = sheet.mesh;
    TopologyChange topology;
    const TopologyCounts counts = sheet.change(topology, field, 0.15);
    EXPECT_EQ(counts.replaced + counts.refused, 0u);
    EXPECT_EQ(sheet.mesh.position, before.position);
    EXPECT_EQ(sheet.mesh.triangles, before.triangles);
    EXPECT_EQ(sheet.mesh.next_id, before.next_id);
  }
}

TEST(Topology, ABodyFarAwayIsBornAndSeen) {
  // The mesh has the one body, the field two, a thousand kilometres apart.
  const auto particles = [](std::initializer_list<double> places) {
    FieldParticles bodies;
    for (const double x : places) {
      bodies.position.emplace_back(x, 0.5 * x, 0.1);
      bodies.velocity.push_back(Vec3::Zero());
      bodies.sigma.push_back(1);
      bodies.weight.push_back(1);
      bodies.weight_rate.push_back(0);
    }
    return bodies;
  };
  const ParticleField one(particles({0}), 0.5, 0), two(particles({0, 1e6}), 0.5, 0);
  Sheet sheet(one, two, 0.15);
  const std::vector<Vec3> before = sheet.mesh.position;
  TopologyChange topology;
  const TopologyCounts counts = sheet.change(topology, two, 0.15);
  EXPECT_EQ(counts.replaced, 1u);
  EXPECT_EQ(counts.refused, 0u);
  EXPECT_EQ(topology_of(sheet.mesh), (ComponentsGenus{2, 0}));
  EXPECT_TRUE(std::ranges::equal(before, std::span(sheet.mesh.position).first(before.size())));
  EXPECT_EQ(topology_of(seen_by_lattice(sheet.mesh, isosurface_lattice(two, 0.25))), (ComponentsGenus{2, 0}));
}

TEST(Topology, IsComparedAgainWhereSomethingChanged) {
  // The mesh has the one body; the field a second one, near it or far away, that only the lattice can tell.
  const ParticleField one(testing::rotating_particles({Vec3(0, 0, 0)}, 1.0, 0.0), 0.3, 0);
  for (const double place : {2.5, 60.0}) {
    const ParticleField two(testing::rotating_particles({Vec3(0, 0, 0), Vec3(place, 0, 0)}, 1.0, 0.0), 0.3,
                            0);
    Sheet sheet(one, two, 0.15);
    TopologyChange topology;
    const auto again = [&](char touched) {
      const std::vector<char> all(sheet.mesh.vertex_count(), touched);
      return topology.change(two, {.follows_field = true}, 0.15, {}, Comparison::repeated, sheet.mesh, all)
          .replaced;
    };
    EXPECT_EQ(again(0), 0u) << "nothing has changed";
    EXPECT_EQ(again(1), place < 10 ? 1u : 0u) << "what changed is around the first body";
    if (place > 10) {
      EXPECT_EQ(sheet.change(topology, two, 0.15).replaced, 1u) << "everywhere";
    }
    EXPECT_EQ(topology_of(sheet.mesh), (ComponentsGenus{2, 0}));
  }
}

TEST(Topology, VerticesElsewhereKeepEverything) {
  const ParticleField apart = two_drops(1.5), merged = two_drops(1.2);
  Sheet sheet(apart, merged, 0.15);
  ASSERT_EQ(topology_of(sheet.mesh), (ComponentsGenus{2, 0}));
  const auto drop_at = [](const Vec3& x) { return x[0] < 0 ? 4 : 7; };
  std::ranges::transform(sheet.mesh.rest_position, sheet.mesh.source.begin(), drop_at);
  const TriangleMesh before = sheet.mesh;
  TopologyChange topology;
  const TopologyCounts counts = sheet.change(topology, merged, 0.15);
  const TriangleMesh& mesh = sheet.mesh;
  EXPECT_EQ(counts.replaced, 1u);
  EXPECT_EQ(counts.refused, 0u);
  EXPECT_EQ(topology_of(mesh), (ComponentsGenus{1, 0}));
  EXPECT_EQ(self_intersections(mesh.position, mesh.triangles), 0u);

  const std::size_t kept = vertices_older_than(mesh, before.next_id);
  EXPECT_GT(kept, before.vertex_count() / 2);
  EXPECT_EQ(mesh.vertex_count() - kept, counts.vertices_born);
  EXPECT_EQ(before.vertex_count() - kept, counts.vertices_lost);
  EXPECT_TRUE(std::ranges::is_sorted(mesh.id, std::less_equal{}));
  EXPECT_LT(mesh.id.back(), mesh.next_id);
  for (std::size_t v = 0; v < kept; ++v) {
    const std::int64_t old = mesh.id[v];  // ids of a first mesh are its vertices' numbers
    EXPECT_EQ(topology.history().before(static_cast<int>(v)), old);
    EXPECT_EQ(mesh.position[v], before.position[old]);
    EXPECT_EQ(mesh.rest_position[v], before.rest_position[old]);
    EXPECT_EQ(mesh.source[v], before.source[old]);
    EXPECT_EQ(mesh.unprojected[v], before.unprojected[old]);
  }
  // New vertices are on the surface, in the neck, and come from the old mesh.
  const SolidDistance old_at_rest(TriangleSurface{before.rest_position, before.triangles});
  for (std::size_t v = kept; v < mesh.vertex_count(); ++v) {
    const int nearer = std::abs(mesh.position[v][0]) > 0.05 ? drop_at(mesh.position[v]) : mesh.source[v];
    EXPECT_EQ(mesh.source[v], nearer) << "of the nearer drop";
    const ValueAndGradient at = merged.value_and_gradient(mesh.position[v]);
    EXPECT_LE(std::abs(at.f), ProjectionOptions{}.tolerance * at.g.norm());
    EXPECT_EQ(sheet.mesh.gradient[v], at.g);
    EXPECT_LT(std::abs(mesh.position[v][0]), 0.6);
    EXPECT_LT(std::abs(old_at_rest.nearest(mesh.rest_position[v]).distance), 1e-12);
    EXPECT_NEAR(sheet.mesh.mobility[v], 0.5, 1e-12);
  }
  EXPECT_EQ(mesh.source.size(), mesh.vertex_count());
  EXPECT_EQ(sheet.mesh.gradient.size(), mesh.vertex_count());
  EXPECT_EQ(sheet.mesh.mobility.size(), mesh.vertex_count());
}

TEST(Topology, NothingIsLeftOfNothingAndComesBack) {
  const ParticleField drops = two_drops(2), nothing(FieldParticles{}, 0.3, 0);
  Sheet sheet(drops, drops, kEdge);
  std::ranges::fill(sheet.mesh.source, 4);
  project_all(nothing, {}, sheet.mesh.position, sheet.mesh.unprojected, sheet.mesh.gradient);
  TopologyChange gone;
  EXPECT_GT(sheet.change(gone, nothing, kEdge).replaced, 0u);
  EXPECT_EQ(sheet.mesh.vertex_count(), 0u);
  EXPECT_TRUE(sheet.mesh.triangles.empty());
  TopologyChange back;
  EXPECT_GT(sheet.change(back, drops, kEdge).replaced, 0u);
  EXPECT_EQ(topology_of(sheet.mesh), (ComponentsGenus{2, 0}));
  EXPECT_EQ(sheet.mesh.rest_position, sheet.mesh.position) << "there was nothing to take it from";
  EXPECT_EQ(sheet.mesh.source, std::vector<int>(sheet.mesh.vertex_count(), kUnknownSource)) << "likewise";
}

}  // namespace
}  // namespace kappaflow
