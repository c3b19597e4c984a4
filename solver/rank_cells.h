// What the ranks that share a liquid tell each other of the viscous preconditioner's cells.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "solver/ranks.h"

namespace kappaflow {

/// Every rank has all cells, and sums over the particles of its own ones: each cell has one owner
/// (LiquidCut). complete() gives it the others'. So all of them solve the same system of cells, to the same
/// bits, and the conjugate gradients take as many iterations as on one rank. Of 64 particles to a cell this
/// is the smaller part of the work, but one that more ranks do not make shorter.
class RankCells {
 public:
  explicit RankCells(Ranks& ranks) : ranks_(&ranks) {}

  Ranks& ranks() const { return *ranks_; }

  /// From the ascending keys of this rank's cells to those of all.
  void merge(std::vector<std::uint64_t>& keys);

  /// values: one a cell, of which this rank knows those of its own cells.
  template <class T>
  void complete(std::vector<T>& values) const {
    complete_ranges(values, [](std::uint32_t cell) { return std::pair(cell, cell + 1); });
  }
  /// values: of the links, each of which is known to the owner of the cell that it is from.
  template <class T>
  void complete_links(std::vector<T>& values, const std::vector<std::uint32_t>& first_link) const {
    complete_ranges(values,
                    [&](std::uint32_t cell) { return std::pair(first_link[cell], first_link[cell + 1]); });
  }

 private:
  std::span<const std::uint32_t> cells_of(std::size_t rank) const {
    return std::span(cells_).subspan(first_[rank], first_[rank + 1] - first_[rank]);
  }
  template <class T, class Range>
  void complete_ranges(std::vector<T>& values, const Range& range_of) const {
    std::vector<std::size_t> sizes(first_.size() - 1, 0);
    for (std::size_t r = 0; r < sizes.size(); ++r)
      for (const std::uint32_t cell : cells_of(r))
        sizes[r] += sizeof(T) * (range_of(cell).second - range_of(cell).first);
    const std::size_t rank = static_cast<std::size_t>(ranks_->rank());
    own_.resize(sizes[rank]);
    all_.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
    std::byte* to = own_.data();
    for (const std::uint32_t cell : cells_of(rank)) {
      const auto [begin, end] = range_of(cell);
      std::memcpy(to, static_cast<const void*>(values.data() + begin), sizeof(T) * (end - begin));
      to += sizeof(T) * (end - begin);
    }
    ranks_->gather(own_, sizes, all_);
    const std::byte* from = all_.data();
    for (std::size_t r = 0; r < sizes.size(); from += sizes[r], ++r) {
      if (r == rank) continue;
      const std::byte* next = from;
      for (const std::uint32_t cell : cells_of(r)) {
        const auto [begin, end] = range_of(cell);
        std::memcpy(static_cast<void*>(values.data() + begin), next, sizeof(T) * (end - begin));
        next += sizeof(T) * (end - begin);
      }
    }
  }

  Ranks* ranks_;
  std::vector<std::uint32_t> cells_;  // rank by rank
  std::vector<std::size_t> first_;    // where each rank's begin, and the end
  mutable std::vector<std::byte> own_, all_;
};

inline void RankCells::merge(std::vector<std::uint64_t>& keys) {
  const std::vector<std::size_t> counts = ranks_->one_of_each(keys.size());
  const std::vector<std::uint64_t> all = ranks_->gathered(std::span<const std::uint64_t>(keys), counts);
  keys = all;
  std::ranges::sort(keys);
  cells_.clear();
  for (const std::uint64_t key : all)
    cells_.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(keys, key) - keys.begin()));
  first_.assign(1, 0);
  for (const std::size_t count : counts) first_.push_back(first_.back() + count);
}

}  // namespace kappaflow
