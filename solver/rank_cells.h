// What the ranks that share a liquid tell each other of the viscous preconditioner's cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/bytes.h"
#include "solver/ranks.h"
#include "solver/rigid_level.h"

namespace kappaflow {

/// The finest cells, each of which has one owner (LiquidCut): that computes its sums, its row of the system
/// and its motion. A rank is told what stands beside its own cells, and the sums of all coarser ones, an
/// eighth of the work and less, which every rank solves for itself, to the same bits. So the conjugate
/// gradients take as many iterations as on one rank.
class RankCells {
 public:
  explicit RankCells(Ranks& ranks) : ranks_(&ranks) {}

  Ranks& ranks() const { return *ranks_; }

  /// From the ascending keys of this rank's cells to those of all.
  void merge(std::vector<std::uint64_t>& keys);
  bool owns(std::size_t cell) const { return owner_[cell] == ranks_->rank(); }
  /// Whether it is an own one or touches one.
  bool knows(std::size_t cell) const { return known_[cell] != 0; }

  /// values: one a cell, of which this rank knows those of its own cells.
  template <class T>
  void complete(std::vector<T>& values) {
    complete_ranges(values, [](std::uint32_t cell) { return std::pair(cell, cell + 1); });
  }
  /// values: of the links, each of which is known to the owner of the cell that it is from.
  template <class T>
  void complete_links(std::vector<T>& values, const std::vector<std::uint32_t>& first_link) {
    complete_ranges(values,
                    [&](std::uint32_t cell) { return std::pair(first_link[cell], first_link[cell + 1]); });
  }

  /// Finds which of the level's cells touch other ranks'.
  void find_borders(const RigidLevel& level);
  /// The motions of the known cells of one colour, from those of the own ones.
  void exchange(std::uint64_t colour, std::vector<RigidVector>& motion);
  /// Gives each link to the owner of the cell that it is to.
  void exchange_links(std::vector<RigidMatrix>& coupling);

  /// From each rank's part of the coarser level's sums over its own cells to all of them. parent: of each
  /// cell.
  void add_up(const RigidLevel& level, std::span<const std::uint32_t> parent, RigidLevel& coarser);
  /// The same of loads. After that for the level's sums.
  void add_up(std::vector<RigidVector>& load);

  std::size_t bytes() const { return bytes_of(cells_, owner_, known_, parents_, outbox_, inbox_); }

 private:
  /// With another rank: cells in the order of their colours, and where each colour begins.
  struct Border {
    int rank = 0;
    std::vector<std::uint32_t> sent, received, links_sent, links_received;
    std::array<std::size_t, RigidLevel::kColours + 1> first_sent{}, first_received{};
  };

  std::span<const std::uint32_t> cells_of(std::size_t rank) const {
    return std::span(cells_).subspan(first_[rank], first_[rank + 1] - first_[rank]);
  }
  template <class T, class Range>
  void complete_ranges(std::vector<T>& values, const Range& range_of);
  template <class T, class Parts>
  void swap(std::vector<T>& values, const Parts& parts_of);

  Ranks* ranks_;
  std::vector<std::uint32_t> cells_;  // rank by rank
  std::vector<std::size_t> first_;    // where each rank's begin, and the end
  std::vector<int> owner_;            // of each cell
  std::vector<char> known_;
  std::vector<Border> borders_;
  std::vector<std::uint32_t> parents_;     // of each rank's cells, rank by rank
  std::vector<std::size_t> first_parent_;  // likewise
  std::vector<std::byte> outbox_, inbox_;
};

template <class T, class Range>
void RankCells::complete_ranges(std::vector<T>& values, const Range& range_of) {
  std::vector<std::size_t> sizes(first_.size() - 1, 0);
  for (std::size_t r = 0; r < sizes.size(); ++r)
    for (const std::uint32_t cell : cells_of(r))
      sizes[r] += sizeof(T) * (range_of(cell).second - range_of(cell).first);
  const std::size_t rank = static_cast<std::size_t>(ranks_->rank());
  outbox_.resize(sizes[rank]);
  inbox_.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  std::byte* to = outbox_.data();
  for (const std::uint32_t cell : cells_of(rank)) {
    const auto [begin, end] = range_of(cell);
    std::memcpy(to, static_cast<const void*>(values.data() + begin), sizeof(T) * (end - begin));
    to += sizeof(T) * (end - begin);
  }
  ranks_->gather(outbox_, sizes, inbox_);
  const std::byte* from = inbox_.data();
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

}  // namespace kappaflow
