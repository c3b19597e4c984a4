#include "solver/rank_cells.h"

#include <algorithm>

namespace kappaflow {
namespace {

template <class T>
void append(std::vector<std::byte>& bytes, std::span<const T> values) {
  const auto own = std::as_bytes(values);
  bytes.insert(bytes.end(), own.begin(), own.end());
}

/// Takes a value from the front of what is left.
template <class T>
T take(std::span<const std::byte>& bytes) {
  T value;
  std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof(T));
  bytes = bytes.subspan(sizeof(T));
  return value;
}

}  // namespace

void RankCells::merge(std::vector<std::uint64_t>& keys) {
  const std::vector<std::size_t> counts = ranks_->one_of_each(keys.size());
  const std::vector<std::uint64_t> all = ranks_->gathered(std::span<const std::uint64_t>(keys), counts);
  keys = all;
  std::ranges::sort(keys);
  cells_.clear();
  for (const std::uint64_t key : all)
    cells_.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(keys, key) - keys.begin()));
  first_.assign(1, 0);
  for (const std::size_t count : counts) first_.push_back(first_.back() + count);
  owner_.resize(keys.size());
  for (std::size_t r = 0; r < counts.size(); ++r)
    for (const std::uint32_t cell : cells_of(r)) owner_[cell] = static_cast<int>(r);
}

void RankCells::find_borders(const RigidLevel& level) {
  const int own = ranks_->rank();
  known_.assign(owner_.size(), 0);
  for (const std::uint32_t cell : cells_of(static_cast<std::size_t>(own))) known_[cell] = 1;
  borders_.clear();
  const auto border_with = [&](int rank) -> Border& {
    const auto at = std::ranges::find(borders_, rank, &Border::rank);
    if (at != borders_.end()) return *at;
    borders_.emplace_back().rank = rank;
    return borders_.back();
  };
  for (std::uint32_t k = 0; k < level.links.size(); ++k) {
    const auto [from, to] = level.links[k];
    if (owns(from) == owns(to)) continue;  // of no concern, or not across a border
    const std::uint32_t inside = owns(from) ? from : to, outside = owns(from) ? to : from;
    Border& border = border_with(owner_[outside]);
    border.sent.push_back(inside);
    border.received.push_back(outside);
    (owns(from) ? border.links_sent : border.links_received).push_back(k);
    known_[outside] = 1;
  }
  std::ranges::sort(borders_, {}, &Border::rank);
  const auto in_order = [&](std::vector<std::uint32_t>& cells, auto& first) {
    std::ranges::sort(cells, {}, [&](std::uint32_t cell) { return std::pair(level.colour(cell), cell); });
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());  // not as a range, for clang 14
    first.fill(0);
    for (const std::uint32_t cell : cells) ++first[level.colour(cell) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
  };
  for (Border& border : borders_) {
    in_order(border.sent, border.first_sent);
    in_order(border.received, border.first_received);
  }
}

/// Of each border the values that are sent and those that are received.
template <class T, class Parts>
void RankCells::swap(std::vector<T>& values, const Parts& parts_of) {
  std::vector<Parcel> out, in;
  std::size_t sent_size = 0, received_size = 0;
  for (const Border& border : borders_) {
    const auto [sent, received] = parts_of(border);
    sent_size += sizeof(T) * sent.size();
    received_size += sizeof(T) * received.size();
  }
  outbox_.resize(sent_size);
  inbox_.resize(received_size);
  std::byte *to = outbox_.data(), *from = inbox_.data();
  for (const Border& border : borders_) {
    const auto [sent, received] = parts_of(border);
    if (!sent.empty()) out.push_back({border.rank, {to, sizeof(T) * sent.size()}});
    if (!received.empty()) in.push_back({border.rank, {from, sizeof(T) * received.size()}});
    from += sizeof(T) * received.size();
    for (const std::uint32_t k : sent) {
      std::memcpy(to, static_cast<const void*>(&values[k]), sizeof(T));
      to += sizeof(T);
    }
  }
  ranks_->exchange(out, in);
  std::span<const std::byte> left(inbox_);
  for (const Border& border : borders_)
    for (const std::uint32_t k : parts_of(border).second) values[k] = take<T>(left);
}

void RankCells::exchange(std::uint64_t colour, std::vector<RigidVector>& motion) {
  swap(motion, [colour](const Border& border) {
    const auto of_colour = [colour](const std::vector<std::uint32_t>& cells, const auto& first) {
      return std::span(cells).subspan(first[colour], first[colour + 1] - first[colour]);
    };
    return std::pair(of_colour(border.sent, border.first_sent),
                     of_colour(border.received, border.first_received));
  });
}

void RankCells::exchange_links(std::vector<RigidMatrix>& coupling) {
  swap(coupling, [](const Border& border) {
    return std::pair(std::span(border.links_sent), std::span(border.links_received));
  });
}

void RankCells::add_up(const RigidLevel& level, std::span<const std::uint32_t> parent, RigidLevel& coarser) {
  parents_.clear();
  first_parent_.assign(1, 0);
  for (std::size_t r = 0; r + 1 < first_.size(); ++r) {
    for (const std::uint32_t cell : cells_of(r))
      if (parents_.size() == first_parent_.back() || parents_.back() != parent[cell])
        parents_.push_back(parent[cell]);
    first_parent_.push_back(parents_.size());
  }

  std::vector<char> touched(coarser.cells(), 0);
  for (const std::uint32_t cell : cells_of(static_cast<std::size_t>(ranks_->rank()))) {
    touched[parent[cell]] = 1;
    for (std::uint32_t k = level.first_link[cell]; k < level.first_link[cell + 1]; ++k)
      touched[parent[level.links[k].to]] = 1;
  }
  const auto links_of = [&](std::uint32_t cell) {
    const std::uint32_t begin = coarser.first_link[cell];
    return std::span(coarser.coupling).subspan(begin, coarser.first_link[cell + 1] - begin);
  };
  std::vector<std::byte> own;
  for (std::uint32_t cell = 0; cell < coarser.cells(); ++cell) {
    if (touched[cell] == 0) continue;
    append(own, std::span<const std::uint32_t>(&cell, 1));
    append(own, std::span<const RigidMatrix>(&coarser.anchor[cell], 1));
    append(own, std::span<const RigidMatrix>(links_of(cell)));
  }
  const std::vector<std::byte> all = ranks_->gathered(own);
  std::ranges::fill(coarser.anchor, RigidMatrix());
  std::ranges::fill(coarser.coupling, RigidMatrix());
  for (std::span<const std::byte> left(all); !left.empty();) {
    const auto cell = take<std::uint32_t>(left);
    coarser.anchor[cell] += take<RigidMatrix>(left);
    for (RigidMatrix& coupling : links_of(cell)) coupling += take<RigidMatrix>(left);
  }
}

void RankCells::add_up(std::vector<RigidVector>& load) {
  const auto parents_of = [this](std::size_t rank) {
    return std::span(parents_).subspan(first_parent_[rank], first_parent_[rank + 1] - first_parent_[rank]);
  };
  std::vector<std::size_t> sizes(first_parent_.size() - 1);
  for (std::size_t r = 0; r < sizes.size(); ++r) sizes[r] = sizeof(RigidVector) * parents_of(r).size();
  outbox_.clear();
  for (const std::uint32_t cell : parents_of(static_cast<std::size_t>(ranks_->rank())))
    append(outbox_, std::span<const RigidVector>(&load[cell], 1));
  inbox_.resize(std::accumulate(sizes.begin(), sizes.end(), std::size_t{0}));
  ranks_->gather(outbox_, sizes, inbox_);
  std::ranges::fill(load, RigidVector());
  std::span<const std::byte> left(inbox_);
  for (const std::uint32_t cell : parents_) load[cell] += take<RigidVector>(left);
}

}  // namespace kappaflow
