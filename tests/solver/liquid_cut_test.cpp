#include "solver/liquid_cut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "solver/fluid_particles.h"
#include "tests/solver/shapes.h"
#include "tests/thread_ranks.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.05;

std::vector<Vec4f> places(const std::vector<Vec3>& points) {
  std::vector<Vec4f> result;
  for (const Vec3& x : points) result.emplace_back(padded(x));
  return result;
}

/// The cuts that the ranks make of the points, of which each has every size-th. shares: none, all the same.
std::vector<LiquidCut> cuts_of(const std::vector<Vec4f>& points, int size,
                               const std::vector<double>& shares = {}) {
  std::vector<LiquidCut> cuts(static_cast<std::size_t>(size), LiquidCut(kSpacing));
  RankBoard board(size);
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      std::vector<Vec4f> own;
      for (std::size_t i = static_cast<std::size_t>(rank); i < points.size();
           i += static_cast<std::size_t>(size))
        own.push_back(points[i]);
      ThreadRanks ranks(board, rank);
      if (!shares.empty()) ranks.set_shares(shares);
      cuts[static_cast<std::size_t>(rank)].cut(own, ranks);
    });
  threads.clear();
  return cuts;
}

std::vector<std::vector<Vec4f>> shapes() {
  std::vector<Vec3> far = test::blob(0.4, kSpacing);
  for (const Vec3& x : test::blob(0.3, kSpacing)) far.push_back(x + Vec3(1e4, -2e4, 3e3));
  return {places(test::block({0, 0, 0}, {4, 0.3, 1}, kSpacing)), places(test::blob(0.6, kSpacing)),
          places(far), places({Vec3(1, 2, 3)})};
}

/// Holds that each rank has its share of the points, but for a cell: a halving is off by half of one; the
/// shares of what is left even that out again.
void expect_shares(const std::vector<Vec4f>& points, const LiquidCut& cut,
                   const std::vector<double>& shares) {
  std::map<LiquidCut::Place, double> in_cell;
  std::map<int, double> of_rank;
  for (const Vec4f& x : points) {
    ++in_cell[cut.place_of(x)];
    ++of_rank[cut.owner_of(cut.place_of(x))];
  }
  double largest = 0;
  for (const auto& [place, count] : in_cell) largest = std::max(largest, count);
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (std::size_t rank = 0; rank < shares.size(); ++rank)
    EXPECT_NEAR(of_rank[static_cast<int>(rank)], static_cast<double>(points.size()) * shares[rank] / all,
                1 + largest)
        << rank << " of " << shares.size() << ", " << points.size() << " points";
  EXPECT_LE(of_rank.size(), shares.size());
}

TEST(LiquidCut, SharesParticlesEvenlyAsCellsAllow) {
  for (const std::vector<Vec4f>& points : shapes())
    for (const int size : {1, 2, 3, 5, 8})
      expect_shares(points, cuts_of(points, size).front(),
                    std::vector<double>(static_cast<std::size_t>(size), 1));
}

TEST(LiquidCut, GivesUnequalRanksTheirShares) {
  const std::vector<std::vector<double>> all{
      {1, 0.52}, {30, 1000}, {1, 0.5, 0.25}, {0.1, 1, 0.3, 0.8}, {1, 1, 0.4, 1, 0.2}};
  for (const std::vector<Vec4f>& points : shapes())
    for (const std::vector<double>& shares : all)
      expect_shares(points, cuts_of(points, static_cast<int>(shares.size()), shares).front(), shares);
}

TEST(LiquidCut, IsWithEqualSharesAsWithNone) {
  for (const std::vector<Vec4f>& points : shapes())
    for (const int size : {2, 3, 5, 8, 13}) {
      const LiquidCut with = cuts_of(points, size, std::vector(static_cast<std::size_t>(size), 0.7)).front(),
                      without = cuts_of(points, size).front();
      for (const Vec4f& x : points)
        ASSERT_EQ(with.owner_of(with.place_of(x)), without.owner_of(without.place_of(x))) << size;
    }
}

// Of shares so far apart that their quotient vanishes.
TEST(LiquidCut, CanLeaveRanksWithoutLiquid) {
  const std::vector<Vec4f> points = shapes()[1];
  const LiquidCut cut = cuts_of(points, 4, {1e300, 1e-300, 1e-300, 1e-300}).front();
  for (const Vec4f& x : points) ASSERT_EQ(cut.owner_of(cut.place_of(x)), 0);
}

using Loads = std::vector<std::pair<LiquidCut::Place, std::uint64_t>>;  // cells and the particles in them

/// Recursive bisection as it is written in books, of all cells at once.
void halve(const Loads& loads, int first_rank, int ranks, std::map<LiquidCut::Place, int>& owner) {
  if (ranks == 1)
    for (const auto& [place, count] : loads) owner[place] = first_rank;
  if (ranks == 1 || loads.empty()) return;
  std::vector<std::pair<std::int64_t, int>> extents;  // the longest first, of the same the first axis
  for (int a = 0; a < 3; ++a) {
    const auto along = [a](const auto& load) { return load.first[static_cast<std::size_t>(a)]; };
    const auto [least, most] = std::ranges::minmax(loads, {}, along);
    extents.emplace_back(along(least) - along(most), a);
  }
  std::ranges::sort(extents);
  Loads sorted = loads;
  std::ranges::sort(sorted, {}, [&](const auto& load) {
    LiquidCut::Place place;
    for (std::size_t k = 0; k < 3; ++k) place[k] = load.first[static_cast<std::size_t>(extents[k].second)];
    return place;
  });
  std::uint64_t all = 0, before = 0;
  for (const auto& [place, count] : loads) all += count;
  const int here = ranks / 2;
  const std::uint64_t wanted = all * static_cast<std::uint64_t>(here) / static_cast<std::uint64_t>(ranks);
  auto cut = sorted.begin();  // a cell is on the side where its middle lies
  for (; cut != sorted.end() && before + cut->second / 2 < wanted; ++cut) before += cut->second;
  halve(Loads(sorted.begin(), cut), first_rank, here, owner);
  halve(Loads(cut, sorted.end()), first_rank + here, ranks - here, owner);
}

TEST(LiquidCut, IsRecursiveBisection) {
  std::vector<std::vector<Vec4f>> all = shapes();
  std::vector<Vec3> uneven;  // few cells, which hold from none to all 64 particles
  for (const Vec3& x : test::block({-2, -1, 0}, {1, 1, 0.2}, kSpacing))
    if (std::sin(7 * x.x()) + std::cos(5 * x.y()) > 4 * x.z()) uneven.push_back(x);
  all.push_back(places(uneven));
  for (const std::vector<Vec4f>& points : all)
    for (const int size : {2, 3, 8, 13}) {
      const LiquidCut cut = cuts_of(points, size).back();
      std::map<LiquidCut::Place, std::uint64_t> in_cell;
      for (const Vec4f& x : points) ++in_cell[cut.place_of(x)];
      std::map<LiquidCut::Place, int> owner;
      halve(Loads(in_cell.begin(), in_cell.end()), 0, size, owner);
      for (const auto& [place, rank] : owner)
        EXPECT_EQ(cut.owner_of(place), rank) << size << " ranks, " << points.size() << " points";
    }
}

TEST(LiquidCut, IsTheSameOnAllRanksAlsoWhereNoLiquidIs) {
  const std::vector<Vec4f> points = shapes()[2];
  const std::vector<LiquidCut> cuts = cuts_of(points, 5);
  for (std::int64_t x = -20; x < 20; x += 3)
    for (std::int64_t y = -20; y < 20; y += 2)
      for (const LiquidCut& cut : cuts)
        EXPECT_EQ(cut.owner_of({x, y, x - y}), cuts[0].owner_of({x, y, x - y}));
  EXPECT_EQ(cuts[0].owner_of(cuts[0].place_of(Vec4f(1e30f, 0, 0, 0))),
            cuts[4].owner_of(cuts[4].place_of(Vec4f(1e30f, 0, 0, 0))));
}

// Two ranks of a long block touch in one plane.
TEST(LiquidCut, GoesAcrossTheLongestExtent) {
  const std::vector<Vec4f> points = shapes()[0];
  const LiquidCut cut = cuts_of(points, 2).front();
  for (const Vec4f& x : points)
    if (std::abs(x[0] - 2) > 0.2f) {
      EXPECT_EQ(cut.owner_of(cut.place_of(x)), x[0] > 2 ? 1 : 0) << x.transpose();
    }
}

}  // namespace
}  // namespace kappaflow
