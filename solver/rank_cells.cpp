#include "solver/rank_cells.h"

#include <algorithm>

#include "solver/rigid_level.h"

namespace kappaflow {
namespace {

// A level is whole that has one cell, or less, for so many that a rank has of the finest. What all ranks do
// alike is then less than what is their own, and spares them messages.
constexpr std::size_t kLessThanShare = 2;

/// Whether test(place) is true for one of the 26 places around.
template <class Test>
bool any_touching(const LiquidCut::Place& place, const Test& test) {
  for (std::int64_t z = place[2] - 1; z <= place[2] + 1; ++z)
    for (std::int64_t y = place[1] - 1; y <= place[1] + 1; ++y)
      for (std::int64_t x = place[0] - 1; x <= place[0] + 1; ++x) {
        const LiquidCut::Place other{x, y, z};
        if (RigidLevel::has_key(other) && other != place && test(other)) return true;
      }
  return false;
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());  // not as a range, for clang 14
}

/// Those at which `flags` is set.
std::vector<std::uint64_t> flagged(const std::vector<std::uint64_t>& keys, const std::vector<char>& flags) {
  std::vector<std::uint64_t> result;
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (flags[k] != 0) result.push_back(keys[k]);
  return result;
}

}  // namespace

std::size_t RankCells::bytes() const {
  std::size_t sum = exchange_.bytes() + border_.bytes() + border_links_.bytes() +
                    bytes_of(owner_, cells_, first_, outbox_, inbox_);
  for (const ExchangePlan& plan : border_of_colour_) sum += plan.bytes();
  return sum;
}

RankCells RankCells::coarser() const {
  RankCells result(ranks(), *cut_);
  result.first_place_ = first_place_;
  result.doublings_ = doublings_ + 1;
  result.most_of_whole_ = doublings_ == 0 ? total_ / (kLessThanShare * size()) : most_of_whole_;
  return result;
}

/// Of the cell at a place of this level.
int RankCells::owner_of(const LiquidCut::Place& place) const {
  LiquidCut::Place corner = first_place_;
  for (std::size_t a = 0; a < 3; ++a) corner[a] += place[a] << doublings_;
  return cut_->owner_of(corner);
}

std::vector<int> RankCells::owners_of(const Keys& keys) const {
  std::vector<int> owners(keys.size());
  parallel_for(keys.size(), [&](std::size_t k) { owners[k] = owner_of(RigidLevel::place_of(keys[k])); });
  return owners;
}

/// The owners are told first, so that each knows its cells: of some it may have no particles.
void RankCells::list(Keys& keys) {
  listed_.assign(size(), {});
  const std::vector<int> owners = owners_of(keys);
  for (std::size_t k = 0; k < keys.size(); ++k)
    listed_[static_cast<std::size_t>(owners[k])].push_back(keys[k]);
  Keys own;
  own.swap(listed_[rank()]);
  listing_ = swapped(ranks(), listed_);
  for (const Keys& of_rank : listing_) own.insert(own.end(), of_rank.begin(), of_rank.end());
  sort_unique(own);
  const std::vector<std::size_t> counts = ranks().one_of_each(own.size());
  total_ = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  whole_ = total_ <= most_of_whole_;
  if (whole_) return list_all(own, counts, keys);
  list_touching(own);
  keys = own;
  for (const Keys& of_rank : listed_) keys.insert(keys.end(), of_rank.begin(), of_rank.end());
  std::ranges::sort(keys);
  owner_ = owners_of(keys);
}

/// Adds to listed_ what touches these cells. Each rank sends its cells to the owners of the places beside
/// them, which know whether there are cells.
void RankCells::list_touching(const Keys& own) {
  const std::vector<Keys> beside = swapped(ranks(), beside_others(own));
  const auto is_own = [&](const LiquidCut::Place& place) {
    return std::ranges::binary_search(own, RigidLevel::key_of(place));
  };
  for (std::size_t r = 0; r < beside.size(); ++r) {
    std::vector<char> touches(beside[r].size());
    parallel_for(touches.size(), [&](std::size_t k) {
      touches[k] = any_touching(RigidLevel::place_of(beside[r][k]), is_own) ? 1 : 0;
    });
    const Keys touching = flagged(beside[r], touches);
    listed_[r].insert(listed_[r].end(), touching.begin(), touching.end());
    sort_unique(listed_[r]);
  }
}

/// Those of these cells that touch places of each other rank.
std::vector<RankCells::Keys> RankCells::beside_others(const Keys& own) const {
  std::vector<char> at_border(own.size());
  parallel_for(own.size(), [&](std::size_t k) {
    const auto is_other = [&](const LiquidCut::Place& place) { return owner_of(place) != ranks().rank(); };
    at_border[k] = any_touching(RigidLevel::place_of(own[k]), is_other) ? 1 : 0;
  });
  std::vector<Keys> result(size());
  for (const std::uint64_t key : flagged(own, at_border))
    any_touching(RigidLevel::place_of(key), [&](const LiquidCut::Place& place) {
      const std::size_t owner = static_cast<std::size_t>(owner_of(place));
      Keys& of_rank = result[owner];
      if (owner != rank() && (of_rank.empty() || of_rank.back() != key)) of_rank.push_back(key);
      return false;
    });
  return result;
}

void RankCells::list_all(const Keys& own, std::span<const std::size_t> counts, Keys& keys) {
  const Keys all = ranks().gathered(std::span<const std::uint64_t>(own), counts);
  keys = all;
  std::ranges::sort(keys);
  cells_.clear();
  for (const std::uint64_t key : all)
    cells_.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(keys, key) - keys.begin()));
  first_.assign(1, 0);
  for (const std::size_t count : counts) first_.push_back(first_.back() + count);
}

void RankCells::find_borders(const RigidLevel& level) {
  std::vector<std::vector<std::uint32_t>> sent(size()), received(size()), links_sent(size()),
      links_received(size());
  for (std::size_t r = 0; r < size(); ++r) {
    for (const std::uint64_t key : listing_[r]) sent[r].push_back(level.find(key));
    for (const std::uint64_t key : listed_[r]) received[r].push_back(level.find(key));
  }
  for (std::uint32_t k = 0; k < level.links.size(); ++k) {
    const auto [from, to] = level.links[k];
    if (owns(from) == owns(to)) continue;  // of no concern, or not across a border
    const std::uint32_t inside = owns(from) ? from : to, outside = owns(from) ? to : from;
    const std::size_t other = static_cast<std::size_t>(owner_[outside]);
    sent[other].push_back(inside);
    (owns(from) ? links_sent : links_received)[other].push_back(k);
  }
  border_ = border_links_ = {};
  border_of_colour_.assign(RigidLevel::kColours, {});
  const auto add = [&](std::size_t r, auto side, const std::vector<std::uint32_t>& cells) {
    (border_.*side).add(static_cast<int>(r), cells);
    std::vector<std::vector<std::uint32_t>> of_colour(RigidLevel::kColours);
    for (const std::uint32_t cell : cells) of_colour[level.colour(cell)].push_back(cell);
    for (std::size_t c = 0; c < of_colour.size(); ++c)
      (border_of_colour_[c].*side).add(static_cast<int>(r), of_colour[c]);
  };
  for (std::size_t r = 0; r < size(); ++r) {
    sort_unique(sent[r]);
    add(r, &ExchangePlan::sent, sent[r]);
    add(r, &ExchangePlan::received, received[r]);
    border_links_.sent.add(static_cast<int>(r), links_sent[r]);
    border_links_.received.add(static_cast<int>(r), links_received[r]);
  }
  listed_.clear();
  listing_.clear();
}

void RankCells::add_up_matrices(RigidLevel& level) {
  /// A link's coupling, or a cell's anchor: then from == to.
  struct Part {
    std::uint64_t from = 0, to = 0;
    RigidMatrix matrix;
  };
  std::vector<std::vector<Part>> parts(size());
  border_.received.for_parts([&](int owner, std::span<const std::uint32_t> cells) {
    const auto add = [&](std::uint32_t from, std::uint32_t to, const RigidMatrix& matrix) {
      if (!rigid::resists(matrix)) return;
      parts[static_cast<std::size_t>(owner)].push_back({level.key[from], level.key[to], matrix});
    };
    for (const std::uint32_t cell : cells) {
      add(cell, cell, level.anchor[cell]);
      for (std::uint32_t k = level.first_link[cell]; k < level.first_link[cell + 1]; ++k)
        add(cell, level.links[k].to, level.coupling[k]);
    }
  });
  for (const std::vector<Part>& of_rank : swapped(ranks(), std::move(parts)))
    for (const Part& part : of_rank) {
      const std::uint32_t from = level.find(part.from), to = level.find(part.to);
      if (from == to) level.anchor[from] += part.matrix;
      for (std::uint32_t k = level.first_link[from]; k < level.first_link[from + 1]; ++k)
        if (level.links[k].to == to) level.coupling[k] += part.matrix;
    }
  if (!whole_) return;
  complete(level.anchor);
  complete_ranges(level.coupling, [&](std::uint32_t cell) {
    return std::pair(level.first_link[cell], level.first_link[cell + 1]);
  });
}

}  // namespace kappaflow
