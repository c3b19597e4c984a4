#include "tools/commands/benchmark.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

void expect_shares(const std::vector<double>& speeds, const std::vector<double>& expected) {
  const std::vector<double> shares = balanced_shares(speeds);
  ASSERT_EQ(shares.size(), expected.size());
  for (std::size_t rank = 0; rank < shares.size(); ++rank) EXPECT_NEAR(shares[rank], expected[rank], 1e-12);
}

TEST(Benchmark, SharesLiquidByTheSpeedsOfRanks) {
  expect_shares({2e5, 1e5}, {1, 0.5});
  expect_shares({1e5, 4e5, 2e5}, {0.25, 1, 0.5});
  expect_shares({3e5}, {1});
}

TEST(Benchmark, TakesRanksOfAboutTheSameSpeedForEqual) {
  expect_shares({95, 100, 91}, {1, 1, 1});
  expect_shares({102, 50, 98, 52, 20}, {1, 0.51, 1, 0.51, 0.2});
}

}  // namespace
}  // namespace kappaflow
