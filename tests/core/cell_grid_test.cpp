#include "core/cell_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "core/errors.h"
#include "core/point_tree.h"

namespace kappaflow {
namespace {

std::vector<Vec3> random_points(int count, double extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-extent, extent);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) p = Vec3(coordinate(random), coordinate(random), coordinate(random));
  return points;
}

std::set<std::uint32_t> found_by_grid(const CellGrid& grid, std::span<const Vec3> points, const Vec3& x,
                                      double r) {
  std::set<std::uint32_t> found;
  grid.ranges_near(x, r, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t k = begin; k != end; ++k) {
      const std::uint32_t i = grid.order()[k];
      if ((points[i] - x).squaredNorm() < r * r) {
        EXPECT_TRUE(found.insert(i).second) << "visited twice: " << i;
      }
    }
  });
  return found;
}

std::set<std::uint32_t> found_by_brute_force(std::span<const Vec3> points, const Vec3& x, double r) {
  std::set<std::uint32_t> found;
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if ((points[i] - x).squaredNorm() < r * r) found.insert(i);
  return found;
}

TEST(CellGrid, FindsWhatBruteForceFindsAtAnyRadius) {
  const auto points = random_points(500, 1, 1);
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), 0.3);
  for (const double radius : {0.1, 0.3, 0.75})
    for (const Vec3& x : random_points(100, 1.5, 2))  // some outside of the grid
      EXPECT_EQ(found_by_grid(grid, points, x, radius), found_by_brute_force(points, x, radius));
}

TEST(CellGrid, FindsWhatAKdTreeFinds) {
  const auto points = random_points(5000, 1, 3);
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), 0.1);
  const PointCloud cloud{points};
  const PointTree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  for (const Vec3& x : random_points(200, 1, 4)) {
    PointsInReach<double> matches;
    tree.radiusSearch(x.data(), 0.1 * 0.1, matches, {});
    std::set<std::uint32_t> expected;
    for (const auto& match : matches) expected.insert(match.first);
    EXPECT_EQ(found_by_grid(grid, points, x, 0.1), expected);
  }
}

TEST(CellGrid, HandlesDegenerateClouds) {
  CellGrid grid;
  grid.build(std::span<const Vec3>(), 1.0);
  EXPECT_TRUE(found_by_grid(grid, {}, Vec3::Zero(), 1).empty());

  const std::vector<Vec3> same(10, Vec3(1, 2, 3));
  grid.build(std::span<const Vec3>(same), 1.0);
  EXPECT_EQ(found_by_grid(grid, same, Vec3(1, 2, 3), 1e-9).size(), 10u);
  EXPECT_TRUE(found_by_grid(grid, same, Vec3(9, 2, 3), 1).empty());
}

TEST(CellGrid, AParticleFarAwayCostsNoMemoryAndHidesNobody) {
  auto points = random_points(200, 1, 5);
  points.push_back(Vec3(1e7, -1e7, 1e7));
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), 0.1);
  for (const Vec3& x : random_points(50, 1, 6))
    EXPECT_EQ(found_by_grid(grid, points, x, 0.1), found_by_brute_force(points, x, 0.1));
  EXPECT_EQ(found_by_grid(grid, points, points.back(), 0.1).size(), 1u);
}

TEST(CellGrid, KeepsTheOrderOfPointsWithinACell) {
  const std::vector<Vec3> points{{0.1, 0, 0}, {5, 0, 0}, {0.3, 0, 0}, {0.2, 0, 0}};
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), 1.0);
  EXPECT_EQ(std::vector<std::uint32_t>(grid.order().begin(), grid.order().end()),
            (std::vector<std::uint32_t>{0, 2, 3, 1}));
}

TEST(CellGrid, TakesSinglePrecisionPaddedPoints) {
  const std::vector<Vec4f> points{{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 3, 0, 0}};
  CellGrid grid;
  grid.build(std::span<const Vec4f>(points), 1.0);
  std::size_t visited = 0;
  grid.ranges_near(points[0], 1.0, [&](std::uint32_t begin, std::uint32_t end) { visited += end - begin; });
  EXPECT_EQ(visited, 2u);
}

// The arithmetic alone: so many points would not fit into memory.
TEST(CellCounts, StayBelowTheIndicesOf32Bits) {
  const CellCounts many = cell_counts(Vec3(2000, 2000, 1500), 1, std::size_t{1} << 27);
  EXPECT_EQ(many.cell_size, 2) << "at 1, 45 cells a point would be more than 2^32";
  EXPECT_EQ(many.dims, (std::array<int, 3>{1001, 1001, 751}));
  const CellCounts few = cell_counts(Vec3(10, 20, 30), 1, 5000);
  EXPECT_EQ(few.dims, (std::array<int, 3>{11, 21, 31}));
  const CellCounts line = cell_counts(Vec3(1e15, 0, 0), 1, std::size_t{1} << 31);
  EXPECT_GT(line.dims[0], 1 << 29);  // an int for every one of them
  EXPECT_EQ(line.dims[1], 1);
  EXPECT_THROW(cell_counts(Vec3(1, 1, 1), 1, std::size_t{1} << 32), InvalidInput);
}

TEST(CellCounts, RefuseWhatIsNotFinite) {
  for (const double x : {HUGE_VAL, std::nan("")})
    EXPECT_THROW(cell_counts(Vec3(1, x, 1), 1, 10), InvalidInput);
  EXPECT_LE(cell_counts(Vec3(1e300, 1, 1e308), 1e-3, 10).dims[0], 65536);
  const std::vector<Vec3> points{Vec3(-1e308, 0, 0), Vec3(1e308, 0, 0)};
  CellGrid grid;
  EXPECT_THROW(grid.build(std::span<const Vec3>(points), 1), InvalidInput);
}

TEST(CellGrid, FindsNothingNearWhatIsNotFiniteOrFarAway) {
  const auto points = random_points(100, 1, 8);
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), 0.3);
  for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e300}) {
    EXPECT_TRUE(found_by_grid(grid, points, Vec3(x, 0, 0), 0.3).empty());
    EXPECT_FALSE(grid.cell_holding(Vec3(0, x, 0)).has_value());
  }
}

TEST(WholeWithin, HoldsForAnyNumber) {
  const double nan = std::nan("");
  EXPECT_EQ(whole_within(3.9, -10, 10), 3);
  EXPECT_EQ(whole_within(-3.9, -10, 10), -3);
  for (const double x : {1e300, HUGE_VAL}) {
    EXPECT_EQ(whole_within(x, -10, std::numeric_limits<int>::max()), std::numeric_limits<int>::max());
    EXPECT_EQ(whole_within(-x, std::numeric_limits<int>::min(), 10), std::numeric_limits<int>::min());
    EXPECT_EQ(whole_within<std::size_t>(x, 0, std::size_t{1} << 53), std::size_t{1} << 53);
  }
  EXPECT_EQ(whole_within(nan, -10, 10), -10);
  EXPECT_EQ(whole_within<std::uint64_t>(-1, 0, 5), 0u);
}

}  // namespace
}  // namespace kappaflow
