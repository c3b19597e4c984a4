// Numbers that are found by a key, without sorting.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/split_mix.h"

namespace kappaflow {

/// A key for a cell of a grid: 21 bits of each index. Cells 2^21 apart share one, which costs time only where
/// what is found is looked at.
template <class Index>
std::uint64_t cell_key(const std::array<Index, 3>& cell) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  return (static_cast<std::uint64_t>(cell[0]) & kMask) << 42 |
         (static_cast<std::uint64_t>(cell[1]) & kMask) << 21 | (static_cast<std::uint64_t>(cell[2]) & kMask);
}

/// Numbers by 64-bit keys, in buckets that several keys may share, about four in each. In a bucket they keep
/// the order in which they came.
class HashedBins {
 public:
  struct Entry {
    std::uint64_t key;
    int number;
  };

  HashedBins() = default;
  explicit HashedBins(std::span<const Entry> entries)
      : start_(std::bit_ceil(entries.size() / 4 + 1) + 1, 0), entries_(entries.size()) {
    for (const Entry& entry : entries) ++start_[bucket_of(entry.key) + 1];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    for (const Entry& entry : entries) entries_[start_[bucket_of(entry.key)]++] = entry;
    // Filling moved each start to its bucket's end, which is the next one's start: shift back.
    std::rotate(start_.begin(), start_.end() - 1, start_.end());
    start_[0] = 0;
  }

  /// All of them, bucket by bucket; those of bucket b are [start(b), start(b + 1)).
  std::span<const Entry> entries() const { return entries_; }
  std::size_t buckets() const { return start_.size() - 1; }
  std::size_t start(std::size_t bucket) const { return start_[bucket]; }

  /// Those of the bucket in which the key's are.
  std::span<const Entry> near(std::uint64_t key) const {
    const std::size_t bucket = bucket_of(key);
    return entries().subspan(start_[bucket], start_[bucket + 1] - start_[bucket]);
  }

 private:
  std::size_t bucket_of(std::uint64_t key) const { return split_mix(key) & (start_.size() - 2); }

  std::vector<std::size_t> start_{0, 0};  // of each bucket, and the end
  std::vector<Entry> entries_;
};

}  // namespace kappaflow
