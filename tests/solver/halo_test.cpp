// Ghosts come while particles that have none beside them are worked on.
#include "solver/halo.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "solver/neighbours.h"
#include "tests/solver/shapes.h"
#include "tests/thread_ranks.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.05;

/// A rank's share of a block, with ghosts.
struct SharedBlock {
  explicit SharedBlock(Ranks& ranks) : halo(ranks, kSpacing, false), search(static_cast<float>(kSpacing)) {
    particles.halo = &halo;
    if (ranks.rank() == 0)
      for (const Vec3& x : test::block({-1, 0, 0}, {1, 0.5, 0.5}, kSpacing))
        particles.add(x, Vec3::Zero(), 0, 0, 0);
    halo.migrate(particles);
    search.sort(particles);
    halo.find_ghosts(particles);
    search.find(particles, lists);
  }

  /// Of the neighbours of a particle, one after another.
  template <class Value>
  float sum_beside(std::size_t i, const Value& value) const {
    float sum = 0;
    for (const PairBlock& block : lists.of(i))
      for (int k = 0; k < kWide; ++k)
        if (block.present()[k] > 0) sum += value(block.base + block.offset[static_cast<std::size_t>(k)]);
    return sum;
  }

  Halo halo;
  NeighbourSearch search;
  NeighbourLists lists;
  FluidParticles particles;
};

/// A number of a place.
float height_of(const Vec4f& x) {
  return 1 + x[0] + 2 * x[1] - x[2];
}

void expect_that_ghosts_come_in_time(Ranks& ranks) {
  SharedBlock block(ranks);
  const FluidParticles& particles = block.particles;
  const std::size_t own = particles.size(), all = particles.position.size();
  EXPECT_GT(all, own);
  std::vector<float> values(all, NAN), sums(own);  // ghosts have no number until they come
  for (std::size_t i = 0; i < own; ++i) values[i] = height_of(particles.position[i]);
  std::atomic<std::size_t> before = 0;
  const auto row = [&](std::size_t i) {
    if (std::isnan(values.back())) ++before;
    return sums[i] = block.sum_beside(i, [&](std::size_t j) { return values[j]; });
  };
  const float sum =
      sum_over_rows(particles, values, 0.0f, row, [](std::size_t, float of_row) { return of_row; });
  EXPECT_GT(before, 0u);
  EXPECT_LT(before, own);
  for (std::size_t i = 0; i < own; ++i)
    ASSERT_EQ(sums[i], block.sum_beside(i, [&](std::size_t j) { return height_of(particles.position[j]); }));
  EXPECT_EQ(sum, parallel_sum(own, 0.0f, [&](std::size_t i) { return sums[i]; }));
}

TEST(Halo, HasGhostsInTimeForThoseBesideThem) {
  constexpr int kRanks = 3;
  RankBoard board(kRanks);
  std::vector<std::jthread> threads;
  threads.reserve(kRanks);
  for (int rank = 0; rank < kRanks; ++rank)
    threads.emplace_back([&board, rank] {
      ThreadRanks ranks(board, rank);
      expect_that_ghosts_come_in_time(ranks);
    });
}

}  // namespace
}  // namespace kappaflow
