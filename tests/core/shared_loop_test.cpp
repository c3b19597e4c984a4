#include "core/shared_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>

#include "core/errors.h"
#include "tests/thread_ranks.h"

namespace kappaflow {
namespace {

/// Calls `work` on so many processes that share their loops.
void sharing(int size, const std::function<void(Ranks&)>& work) {
  on_each_rank(size, [&](Ranks& ranks) {
    const SharedWork shared(&ranks);
    work(ranks);
  });
}

TEST(SharedLoop, EachElementIsWorkedOnOnceAndKnownToAll) {
  for (const int size : {1, 2, 3, 7}) {
    std::atomic<int> calls = 0;
    sharing(size, [&](Ranks&) {
      std::vector<int> twice(10'001);
      std::vector<Vec3> place(twice.size());
      shared_for(
          twice.size(),
          [&](std::size_t i) {
            ++calls;
            twice[i] = 2 * static_cast<int>(i);
            place[i] = Vec3::Constant(static_cast<double>(i));
          },
          16, twice, place);
      for (std::size_t i = 0; i < twice.size(); ++i) {
        ASSERT_EQ(twice[i], 2 * static_cast<int>(i));
        ASSERT_EQ(place[i][2], static_cast<double>(i));
      }
      EXPECT_EQ(shared_max(
                    twice.size(), -1, [&](std::size_t i) { return i == 4321 ? 5.0 : 0.0; }, 16),
                5.0);
    });
    EXPECT_EQ(calls, 10'001);
  }
}

TEST(SharedLoop, ListsKeepTheirOrder) {
  sharing(3, [](Ranks&) {
    std::vector<std::vector<int>> lists(20);
    shared_lists([&](std::size_t i) { lists[i].assign(i % 5, static_cast<int>(i)); }, lists);
    for (std::size_t i = 0; i < lists.size(); ++i)
      EXPECT_EQ(lists[i], std::vector<int>(i % 5, static_cast<int>(i)));
    std::vector<std::vector<int>> none;
    shared_lists([](std::size_t) { FAIL(); }, none);
  });
}

// The last one meets it alone.
TEST(SharedLoop, WhereOneFailsAllFailAlike) {
  sharing(3, [](Ranks& ranks) {
    std::vector<int> values(5000);
    try {
      shared_for(
          values.size(),
          [&](std::size_t i) {
            if (i == 4000 && ranks.rank() == 2) throw InvalidInput("the 4000th");
          },
          16, values);
      ADD_FAILURE() << ranks.rank();
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()), "the 4000th");
      EXPECT_EQ(error.exit_code(), 2);
    }
    std::vector<int> afterwards(5000);
    shared_for(
        afterwards.size(), [&](std::size_t i) { afterwards[i] = 1; }, 16, afterwards);
    EXPECT_EQ(std::reduce(afterwards.begin(), afterwards.end()), 5000);
  });
}

// What a process is at inside a parallel loop the others need not be.
TEST(SharedLoop, InsideAParallelLoopNothingIsShared) {
  sharing(2, [](Ranks& ranks) {
    std::vector<int> values(2000);
    parallel_for(1, [&](std::size_t) {
      if (ranks.rank() == 0)
        shared_for(
            values.size(), [&](std::size_t i) { values[i] = 1; }, 16, values);
    });
    EXPECT_EQ(std::reduce(values.begin(), values.end()), ranks.rank() == 0 ? 2000 : 0);
    EXPECT_NE(SharedWork::group(), nullptr);
  });
}

std::vector<Vec3> scattered_points() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points(3001);
  for (Vec3& x : points) x = Vec3(unit(random), 3 * unit(random), unit(random));
  for (std::size_t i = 0; i < 1500; ++i) points[i][1] = 1;  // a wall of them
  points[7][1] = std::numeric_limits<double>::quiet_NaN();
  return points;
}

TEST(SharedLoop, SharesAreThoseOfTheRanks) {
  sharing(3, [](Ranks& ranks) {
    ranks.set_shares({1, 0.25, 0.75});
    std::atomic<int> calls = 0;
    std::vector<int> values(4000);
    shared_for(
        values.size(),
        [&](std::size_t i) {
          ++calls;
          values[i] = static_cast<int>(i);
        },
        16, values);
    EXPECT_EQ(calls, (std::vector{2000, 500, 1500})[ranks.rank()]);
    std::vector<int> all(values.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(values, all);
  });
}

TEST(SharedLoop, SlabsHaveAsManyPointsEach) {
  const std::vector<Vec3> points = scattered_points();
  EXPECT_EQ(shares_in_slabs(points).group(), nullptr);
  sharing(4, [&](Ranks& ranks) {
    const ItemShares shares = shares_in_slabs(points);
    std::vector<int> count(4, 0);
    double last = -1;
    for (std::size_t i = 0; i < points.size(); ++i) ++count[shares.owner(i)];
    for (const int n : count) EXPECT_NEAR(n, 750, 1);
    for (int r = 0; r < 4; ++r) {
      double lowest = 4, highest = -1;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (shares.owner(i) == r && i != 7)
          lowest = std::min(lowest, points[i][1]), highest = std::max(highest, points[i][1]);
      EXPECT_GE(lowest, last);
      last = highest;
    }
    std::vector<int> value(points.size(), -1);
    shares.for_own(
        value.size(), [&](std::size_t i) { value[i] = static_cast<int>(i); }, 16);
    EXPECT_EQ(std::ranges::count(value, -1), std::ssize(value) - count[ranks.rank()]);
    shares.gather(std::span(value));
    std::vector<int> all(value.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(value, all);
    const ItemShares others = shares.of(std::vector<int>{5, 5, 2999});
    EXPECT_EQ(others.owner(1), shares.owner(5));
    EXPECT_EQ(others.owner(2), shares.owner(2999));
  });
}

}  // namespace
}  // namespace kappaflow
