#include "core/hashed_bins.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <span>
#include <vector>

namespace kappaflow {
namespace {

TEST(HashedBins, HoldTheNumbersOfEachKeyInTheirOrder) {
  std::mt19937 random(1);
  for (const int count : {0, 1, 5, 3000}) {
    std::vector<HashedBins::Entry> entries;
    std::map<std::uint64_t, std::vector<int>> expected;
    for (int number = 0; number < count; ++number) {
      const std::uint64_t key = (random() % 700) * 0x1000003ull;
      entries.push_back({key, number});
      expected[key].push_back(number);
    }
    const HashedBins bins(entries);
    EXPECT_EQ(bins.entries().size(), entries.size());
    EXPECT_EQ(bins.start(bins.buckets()), entries.size());
    for (const auto& [key, numbers] : expected) {
      std::vector<int> found;
      for (const HashedBins::Entry& entry : bins.near(key))
        if (entry.key == key) found.push_back(entry.number);
      EXPECT_EQ(found, numbers) << key;
    }
    for (const HashedBins::Entry& entry : bins.near(12345)) EXPECT_NE(entry.key, 12345u);
  }
}

TEST(HashedBins, SpreadTheCellsOfASurface) {
  std::vector<HashedBins::Entry> entries;
  for (std::uint64_t i = 0; i < 64; ++i)
    for (std::uint64_t j = 0; j < 64; ++j) entries.push_back({i << 42 | j << 21, 0});
  const HashedBins bins(entries);
  std::size_t most = 0;
  for (std::size_t b = 0; b < bins.buckets(); ++b) most = std::max(most, bins.start(b + 1) - bins.start(b));
  EXPECT_LT(most, 20u);  // four in the mean
}

TEST(HashedBins, AreEmptyWithoutEntries) {
  EXPECT_TRUE(HashedBins().near(7).empty());
  EXPECT_TRUE(HashedBins(std::span<const HashedBins::Entry>()).near(7).empty());
}

}  // namespace
}  // namespace kappaflow
