// Simple points against the homotopy of what they stand for: unions of closed cubes.
#include "surface/topology/simple_points.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

/// The cells of closed unit cubes, of all dimensions: their doubled centres, odd along an axis where they
/// extend.
using Cell = std::tuple<int, int, int>;

std::set<Cell> cells_of(Neighbourhood cubes) {
  std::set<Cell> cells;
  for (int bit = 0; bit < 27; ++bit) {
    if ((cubes >> bit & 1) == 0 || bit == 13) continue;
    for (int n = 0; n < 27; ++n)
      cells.emplace(2 * (bit % 3) + n % 3, 2 * (bit / 3 % 3) + n / 3 % 3, 2 * (bit / 9) + n / 9);
  }
  return cells;
}

/// Whether the cubes around the centre, without it, make one piece that can be shrunk to a point. Cubes that
/// touch a common cube leave no other choice: with one piece and Euler characteristic 1 there is no tunnel
/// and no cavity.
bool is_contractible(Neighbourhood cubes) {
  const std::set<Cell> cells = cells_of(cubes);
  if (cells.empty()) return false;
  int euler = 0;
  for (const auto& [x, y, z] : cells) euler += (x % 2 + y % 2 + z % 2) % 2 == 0 ? 1 : -1;
  std::set<Cell> reached{*cells.begin()};
  std::vector<Cell> pending{*cells.begin()};
  while (!pending.empty()) {
    const auto [x, y, z] = pending.back();
    pending.pop_back();
    for (const Cell& next : {Cell(x - 1, y, z), Cell(x + 1, y, z), Cell(x, y - 1, z), Cell(x, y + 1, z),
                             Cell(x, y, z - 1), Cell(x, y, z + 1)})
      if (cells.contains(next) && reached.insert(next).second) pending.push_back(next);
  }
  return euler == 1 && reached.size() == cells.size();
}

/// Sparse and dense neighbourhoods in turn: half of either has a piece that is cut or a hole.
Neighbourhood random_neighbourhood(std::mt19937& random, int n) {
  const auto inside = static_cast<Neighbourhood>(random() & random());
  return n % 2 == 0 ? ~inside : inside;
}

TEST(SimplePoints, HaveSurroundingsThatShrinkToAPoint) {
  std::mt19937 random(1);
  int simple = 0;
  for (int n = 0; n < 20000; ++n) {
    const Neighbourhood inside = random_neighbourhood(random, n);
    if (!is_simple(inside)) continue;
    ++simple;
    ASSERT_TRUE(is_contractible(inside)) << std::hex << inside;
    ASSERT_TRUE(is_contractible(~inside)) << std::hex << inside;
  }
  EXPECT_GT(simple, 200);
}

/// Pieces and handles of an isosurface of samples on 3 x 3 x 3 points, `inside` or not, amid ones that are
/// not.
MeshTopology surface_of(Neighbourhood inside, bool amid_inside) {
  SampledField lattice;
  lattice.spacing = 1;
  lattice.dims = {7, 7, 7};
  const TriangleMesh mesh = extract_isosurface(lattice, [&](SampledField& s) {
    s.value.assign(343, -1.0f);
    for (int n = 0; n < 125; ++n) {
      const int i = n % 5, j = n / 5 % 5, k = n / 25;
      const bool core = i % 4 != 0 && j % 4 != 0 && k % 4 != 0;
      const bool in = core ? (inside >> (9 * (k - 1) + 3 * (j - 1) + i - 1) & 1) != 0 : amid_inside;
      s.value[(k + 1) * 49 + (j + 1) * 7 + i + 1] = in ? 1.0f : -1.0f;
    }
  });
  return mesh_topology(mesh.position, mesh.triangles);
}

TEST(SimplePoints, KeepTheIsosurfacesPiecesAndHandles) {
  std::mt19937 random(2);
  int simple = 0;
  for (int n = 0; n < 20000; ++n) {
    const Neighbourhood inside = random_neighbourhood(random, n) & ((1u << 27) - 1);
    if (!is_simple(inside)) continue;
    ++simple;
    for (const bool amid_inside : {false, true}) {
      const MeshTopology with = surface_of(inside | 1u << 13, amid_inside),
                         without = surface_of(inside & ~(1u << 13), amid_inside);
      ASSERT_EQ(with.components, without.components) << std::hex << inside;
      ASSERT_EQ(with.genus, without.genus) << std::hex << inside;
    }
  }
  EXPECT_GT(simple, 200);
}

TEST(SimplePoints, OfAFlatSideAreAllButThoseThatPierceIt) {
  const Neighbourhood half_space = (1u << 18) - 1;
  EXPECT_TRUE(is_simple(half_space));
  EXPECT_TRUE(is_simple(half_space & ~(1u << 13)));
  const Neighbourhood slab = half_space & ~((1u << 9) - 1), alone = 0, full = (1u << 27) - 1;
  EXPECT_FALSE(is_simple(slab)) << "one layer: opens a hole";
  EXPECT_FALSE(is_simple(alone)) << "a piece is born or dies";
  EXPECT_FALSE(is_simple(full)) << "a cavity opens";
  EXPECT_FALSE(is_simple(1u << 12 | 1u << 14)) << "joins two";
}

}  // namespace
}  // namespace kappaflow
