// One level of the viscous preconditioner's cells, where ranks share the liquid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "core/bytes.h"
#include "solver/liquid_cut.h"
#include "solver/rank_exchange.h"
#include "solver/rigid_motion.h"

namespace kappaflow {

class RigidLevel;

/// Each cell has one owner, the rank whose place in the cut the cell's lowest corner is: every rank finds it
/// without being told. The owner has the cell's sums, solves its row of the system and has its motion. A rank
/// lists, and is told the motions of, its own cells, those that touch these, and the parents of all that it
/// lists one level below; of the latter it tells the owners what its own cells add to their sums. So cost and
/// memory follow a rank's share and its border.
///
/// A level of few cells, half a rank's share of the finest ones, is whole: every rank lists all of it, is
/// told all sums, and solves it and those above for itself, to the same bits. So the conjugate gradients take
/// as many iterations as on one rank.
class RankCells {
 public:
  RankCells(Ranks& ranks, const LiquidCut& cut) : exchange_(ranks), cut_(&cut) {}
  /// Of the next coarser level.
  RankCells coarser() const;

  Ranks& ranks() const { return exchange_.ranks(); }
  bool is_whole() const { return whole_; }

  /// Where the finest cells' places count from.
  void set_first_place(const LiquidCut::Place& place) { first_place_ = place; }
  /// From the ascending keys of the cells that this rank knows of to those of all that it lists: from its own
  /// ones on the finest level, else from the parents of those that it lists one level below.
  void list(std::vector<std::uint64_t>& keys);
  /// Whether this rank solves the cell's row.
  bool owns(std::size_t cell) const { return whole_ || owner_[cell] == ranks().rank(); }
  /// Plans the exchanges, once the level's listed cells are linked.
  void find_borders(const RigidLevel& level);

  /// Of what each rank knows of its own cells, what it is to know of the others that it lists.
  template <class T>
  void share(std::vector<T>& values) {
    if (!whole_) exchange_.swap(border_, values);
  }
  /// The same of the cells of one colour; until they come: meanwhile().
  template <class T>
  void share_colour(std::uint64_t colour, std::vector<T>& values, const std::function<void()>& meanwhile) {
    if (whole_) return meanwhile();
    exchange_.swap(border_of_colour_[colour], values, meanwhile);
  }
  /// This rank's cells of a colour that others list; on a whole level none.
  std::span<const std::uint32_t> told(std::uint64_t colour) const {
    return whole_ ? std::span<const std::uint32_t>() : border_of_colour_[colour].sent.index;
  }
  /// values: of the links, each of which is known to the owner of the cell that it is from: gives it to that
  /// of the cell that it is to.
  template <class T>
  void share_links(std::vector<T>& values) {
    if (!whole_) exchange_.swap(border_links_, values);
  }

  /// From each rank's part of the sums of the cells that it lists to the sums of its own ones; on a whole
  /// level of all.
  template <class T>
  void add_up(std::vector<T>& values);
  /// The same of the anchors and the couplings.
  void add_up_matrices(RigidLevel& level);

  std::size_t bytes() const;

 private:
  using Keys = std::vector<std::uint64_t>;

  std::size_t size() const { return static_cast<std::size_t>(ranks().size()); }
  std::size_t rank() const { return static_cast<std::size_t>(ranks().rank()); }
  int owner_of(const LiquidCut::Place& place) const;
  std::vector<int> owners_of(const Keys& keys) const;
  std::vector<Keys> beside_others(const Keys& own) const;
  void list_touching(const Keys& own);
  void list_all(const Keys& own, std::span<const std::size_t> counts, Keys& keys);

  std::span<const std::uint32_t> cells_of(std::size_t rank) const {
    return std::span(cells_).subspan(first_[rank], first_[rank + 1] - first_[rank]);
  }
  /// On a whole level: one value a cell, of which each rank knows those of the cells that it owns.
  template <class T>
  void complete(std::vector<T>& values) {
    complete_ranges(values, [](std::uint32_t cell) { return std::pair(cell, cell + 1); });
  }
  template <class T, class Range>
  void complete_ranges(std::vector<T>& values, const Range& range_of);

  RankExchange exchange_;
  const LiquidCut* cut_;
  LiquidCut::Place first_place_{};
  int doublings_ = 0;  // of the width of the finest cells
  std::size_t total_ = 0, most_of_whole_ = 0;
  bool whole_ = false;
  std::vector<Keys> listed_, listing_;  // by rank: its cells that this one lists, and the other way
  std::vector<int> owner_;              // of each cell
  ExchangePlan border_, border_links_;
  std::vector<ExchangePlan> border_of_colour_;
  // Of a whole level:
  std::vector<std::uint32_t> cells_;  // by owner
  std::vector<std::size_t> first_;    // where each rank's begin, and the end
  std::vector<std::byte> outbox_, inbox_;
};

template <class T>
void RankCells::add_up(std::vector<T>& values) {
  const auto read = [&](std::size_t cell) -> const T& { return values[cell]; };
  const std::span<const T> parts = exchange_.swap<T>(border_.received, border_.sent, read);
  for (std::size_t k = 0; k < parts.size(); ++k) values[border_.sent.index[k]] += parts[k];
  if (whole_) complete(values);
}

template <class T, class Range>
void RankCells::complete_ranges(std::vector<T>& values, const Range& range_of) {
  std::vector<std::size_t> sizes(size(), 0);
  for (std::size_t r = 0; r < sizes.size(); ++r)
    for (const std::uint32_t cell : cells_of(r))
      sizes[r] += sizeof(T) * (range_of(cell).second - range_of(cell).first);
  outbox_.resize(sizes[rank()]);
  inbox_.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  std::byte* to = outbox_.data();
  for (const std::uint32_t cell : cells_of(rank())) {
    const auto [begin, end] = range_of(cell);
    std::memcpy(to, static_cast<const void*>(values.data() + begin), sizeof(T) * (end - begin));
    to += sizeof(T) * (end - begin);
  }
  ranks().gather(outbox_, sizes, inbox_);
  const std::byte* from = inbox_.data();
  for (const std::uint32_t cell : cells_) {
    const auto [begin, end] = range_of(cell);
    std::memcpy(static_cast<void*>(values.data() + begin), from, sizeof(T) * (end - begin));
    from += sizeof(T) * (end - begin);
  }
}

}  // namespace kappaflow
