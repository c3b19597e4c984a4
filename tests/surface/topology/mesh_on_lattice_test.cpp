// What a lattice tells of a mesh: winding numbers, cells, bins of triangles, what stays between its points.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/lattice_guard.h"
#include "surface/topology/region_replacement.h"
#include "surface/topology/triangle_bins.h"
#include "surface/topology/winding_numbers.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;

/// At the points of the part.
std::vector<std::int8_t> winding_numbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                         const SampledField& part) {
  const LatticeCell first{part.first_column, part.first_row, part.first_plane};
  LatticeBlock block{first, first};
  for (int a = 0; a < 3; ++a) block.last[a] += part.dims[a] - 1;
  return WindingNumbers(position, triangles, part, std::array{block}).in(part);
}

TEST(WindingNumbers, AreTheSignOfTheFieldAroundItsIsosurface) {
  // Of the same lattice: each cell's triangles part its points inside from those outside.
  for (unsigned seed = 0; seed < 4; ++seed) {
    const ParticleField field = testing::random_blobs(seed, 30, 2);
    const TriangleMesh mesh = extract_isosurface(field, 0.2);
    SampledField lattice = isosurface_lattice(field, 0.2);
    field.sample(lattice);
    const std::vector<std::int8_t> winding = winding_numbers(mesh.position, mesh.triangles, lattice);
    ASSERT_EQ(winding.size(), lattice.value.size());
    std::size_t wrong = 0, inside = 0;
    for (std::size_t i = 0; i < winding.size(); ++i) {
      inside += lattice.value[i] > 0;
      // The rows run some thousandths of a spacing beside the points.
      wrong += std::abs(lattice.value[i]) > 0.005 && winding[i] != (lattice.value[i] > 0 ? 1 : 0);
    }
    EXPECT_EQ(wrong, 0u) << seed;
    EXPECT_GT(inside, 1000u);
  }
}

TEST(WindingNumbers, OfBlocksAreThoseOfTheWholeLattice) {
  const ParticleField field = testing::random_blobs(1, 40, 2.5);
  const TriangleMesh mesh = extract_isosurface(field, 0.1);
  const SampledField lattice = isosurface_lattice(field, 0.07);
  const std::vector<std::int8_t> all = winding_numbers(mesh.position, mesh.triangles, lattice);
  const std::vector<LatticeBlock> blocks{
      {{20, 40, 33}, {50, 64, 60}}, {{0, 0, 0}, {9, 30, 4}}, {{30, 41, 7}, {30, 41, 7}}};
  const WindingNumbers numbers(mesh.position, mesh.triangles, lattice, blocks);
  for (const auto& [first, last] : blocks) {
    SampledField part = lattice;
    restrict_to({first, last}, part);
    const std::vector<std::int8_t> winding = numbers.in(part);
    std::size_t index = 0, wrong = 0;
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i, ++index)
          wrong += winding[index] !=
                   all[(static_cast<std::size_t>(k) * lattice.dims[1] + j) * lattice.dims[0] + i];
    EXPECT_EQ(index, winding.size());
    EXPECT_EQ(wrong, 0u);
  }
}

TEST(TrianglesNear, AreAllThatComeWithinReach) {
  const ParticleField field = testing::random_blobs(2, 40, 2.5);
  const TriangleMesh mesh = extract_isosurface(field, 0.1);
  const SampledField lattice = isosurface_lattice(field, 0.03);
  const LatticeCell there = cell_of(lattice, mesh.position[100]),
                    elsewhere = cell_of(lattice, mesh.position[500]);
  LatticeBlock wide{there, there};
  for (int a = 0; a < 3; ++a) wide.last[a] += 20;
  const std::vector<LatticeBlock> blocks{wide, {elsewhere, elsewhere}, {{0, 0, 0}, {3, 3, 3}}};
  const double reach = 2.5;
  const auto near = triangles_near(lattice, mesh.position, mesh.triangles, blocks, reach);
  ASSERT_EQ(near.size(), blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    EXPECT_TRUE(std::ranges::is_sorted(near[b]));
    EXPECT_LT(near[b].size(), mesh.triangles.size() / 2);
    std::size_t within = 0;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
      bool is_within = true;
      for (int a = 0; a < 3; ++a) {
        const auto place = [&](int v) { return (mesh.position[v][a] - lattice.origin[a]) / lattice.spacing; };
        const auto& [u, v, w] = mesh.triangles[t];
        const auto [least, most] = std::minmax({place(u), place(v), place(w)});
        is_within = is_within && most + reach >= blocks[b].first[a] && least - reach <= blocks[b].last[a];
      }
      within += is_within;
      EXPECT_TRUE(!is_within || std::ranges::binary_search(near[b], t)) << b << " " << t;
    }
    EXPECT_TRUE(within > 0 || b == 2);
  }
}

TEST(WindingNumbers, CountOverlapsAndReversedMeshes) {
  const EllipsoidField ball(Vec3::Zero(), Mat3::Identity(), Vec3::Ones());
  const TriangleMesh one = extract_isosurface(ball, 0.3);
  SampledField lattice;
  lattice.origin = Vec3(-3, -2, -2);
  lattice.spacing = 0.25;
  lattice.first_plane = 1;
  lattice.dims = {30, 17, 15};
  std::vector<Vec3> position = one.position;
  std::vector<Triangle> triangles = one.triangles;
  const int n = static_cast<int>(position.size());
  for (const Vec3& x : one.position) position.emplace_back(x + Vec3(1, 0, 0));
  for (const auto& [a, b, c] : one.triangles) triangles.push_back({n + a, n + b, n + c});
  const std::vector<std::int8_t> two = winding_numbers(position, triangles, lattice);
  for (Triangle& t : triangles) std::swap(t[0], t[1]);
  const std::vector<std::int8_t> reversed = winding_numbers(position, triangles, lattice);
  std::size_t index = 0, overlap = 0;
  for (int k = 0; k < lattice.dims[2]; ++k)
    for (int j = 0; j < lattice.dims[1]; ++j)
      for (int i = 0; i < lattice.dims[0]; ++i, ++index) {
        const Vec3 x = lattice.origin + lattice.spacing * Vec3(i, j, k + lattice.first_plane);
        EXPECT_EQ(reversed[index], -two[index]);
        if (std::abs(x.norm() - 1) < 0.05 || std::abs((x - Vec3(1, 0, 0)).norm() - 1) < 0.05) continue;
        const int expected = (x.norm() < 1) + ((x - Vec3(1, 0, 0)).norm() < 1);
        EXPECT_EQ(two[index], expected) << x.transpose();
        overlap += expected == 2;
      }
  EXPECT_GT(overlap, 50u);
}

const Vec3 kNowhere[] = {Vec3(1e300, 0, 0), Vec3(0, -1e300, 1e300), Vec3(0, HUGE_VAL, 0),
                         Vec3(std::nan(""), 0, 0), Vec3(0, 0, 3e10)};

TEST(FarVertices, AreInSomeCell) {
  SampledField lattice;
  lattice.spacing = 0.25;
  lattice.dims = {8, 8, 8};
  EXPECT_EQ(cell_of(lattice, Vec3(0.3, -0.1, 1)), (LatticeCell{1, -1, 4}));
  EXPECT_EQ(cell_of(lattice, Vec3(1e300, -HUGE_VAL, std::nan(""))),
            (LatticeCell{kFarthestCell, -kFarthestCell, -kFarthestCell}));
  for (const Vec3& x : kNowhere) {
    const std::vector<LatticeCell> cells{cell_of(lattice, x), cell_of(lattice, -x), LatticeCell{0, 0, 0}};
    EXPECT_TRUE(CellRegion(cells, 1000).too_large());
  }
}

TEST(FarVertices, LeaveTheWindingNumbersElsewhere) {
  const EllipsoidField ball(Vec3::Zero(), Mat3::Identity(), Vec3::Ones());
  TriangleMesh mesh = extract_isosurface(ball, 0.3);
  SampledField lattice = isosurface_lattice(ball, 0.25);
  const std::vector<std::int8_t> expected = winding_numbers(mesh.position, mesh.triangles, lattice);
  const int first = static_cast<int>(mesh.vertex_count());
  mesh.position.insert(mesh.position.end(), {Vec3(5, 5, 5), Vec3(6, 5, 5), Vec3(5, 6, 5)});
  for (const Vec3& x : kNowhere) {
    std::vector<Vec3> position = mesh.position;
    std::vector<Triangle> triangles = mesh.triangles;
    position.push_back(x.cwiseAbs() + Vec3::Constant(5));
    triangles.insert(triangles.end(), {{first, first + 1, first + 3}, {first + 3, first + 2, first}});
    EXPECT_EQ(winding_numbers(position, triangles, lattice), expected) << x.transpose();
  }
}

TEST(TriangleBins, FindFarFromTheOrigin) {
  TriangleMesh mesh;
  for (const Vec3& at : {Vec3(5e6, 1e7, 0), Vec3(5e6, 1e7, 1)})
    mesh.position.insert(mesh.position.end(), {at, at + Vec3(1e-3, 0, 0), at + Vec3(0, 1e-3, 0)});
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const TriangleBins bins(mesh, std::vector{0, 1}, 1e-4);  // 1e11 cells from the origin
  for (int t = 0; t < 2; ++t) {
    std::vector<int> found;
    EXPECT_FALSE(bins.any_near(mesh.position[3 * t] + Vec3(2e-4, 2e-4, 0), [&](int near) {
      found.push_back(near);
      return false;
    }));
    EXPECT_EQ(found, std::vector{t});
  }
  for (const Vec3& x : kNowhere) EXPECT_FALSE(bins.any_near(x, [](int) { return true; }));
}

TEST(LatticeGuard, RefusesWhatSweepsFartherThanAMesh) {
  const EllipsoidField ball(Vec3::Zero(), Mat3::Identity(), Vec3::Ones());
  const LatticeGuard guard(ball, isosurface_lattice(ball, 0.25), 0.1);
  for (const Vec3& x : kNowhere)
    EXPECT_FALSE(guard.allows(Vec3(0, 0, 0), Vec3(1, 0.1, 0.2), Vec3(0, 1, 0.3), x)) << x.transpose();
}

TEST(SeenByLattice, LeavesOutWhatPassesBetweenThePoints) {
  // A sphere, and a speck smaller than a cell.
  const SampledField lattice{Vec3::Constant(-2), 0.25, 0, {17, 17, 17}, {}};
  TriangleMesh sphere = extract_isosurface(lattice, [](SampledField& s) {
    s.value.clear();
    for (int k = 0; k < s.dims[2]; ++k)
      for (int j = 0; j < s.dims[1]; ++j)
        for (int i = 0; i < s.dims[0]; ++i)
          s.value.push_back(
              static_cast<float>(1 - (s.origin + s.spacing * Vec3(i, j, s.first_plane + k)).norm()));
  });
  const MeshTopology alone = mesh_topology(sphere.position, sphere.triangles);
  EXPECT_EQ(alone.components, 1);
  const int n = static_cast<int>(sphere.vertex_count());
  for (const Vec3& d : {Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0, 0, 0.1)})
    sphere.position.emplace_back(Vec3(1.55, 1.55, 1.55) + d);
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{2, 0, 3}})
    sphere.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  EXPECT_EQ(mesh_topology(sphere.position, sphere.triangles).components, 2);
  const TriangleMesh seen = seen_by_lattice(sphere, lattice);
  const MeshTopology topology = mesh_topology(seen.position, seen.triangles);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus, 0);
}

}  // namespace
}  // namespace kappaflow
