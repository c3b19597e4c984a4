#include "solver/liquid_cut.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "solver/rigid_level.h"
#include "solver/rigid_multigrid.h"

namespace kappaflow {
namespace {

static_assert(LiquidCut::kCellWidth == RigidMultigrid::kCellWidth);

/// Particles in a cell.
struct KeyLoad {
  std::uint64_t key = 0, count = 0;
};

std::uint64_t key_of(const LiquidCut::Place& place) {
  constexpr std::int64_t largest = LiquidCut::kLargestPlace;
  return RigidLevel::key_of({place[0] + largest, place[1] + largest, place[2] + largest});
}

LiquidCut::Place place_of_key(std::uint64_t key) {
  LiquidCut::Place place = RigidLevel::place_of(key);
  for (std::int64_t& along : place) along -= LiquidCut::kLargestPlace;
  return place;
}

/// One entry a key, ascending.
void merge(std::vector<KeyLoad>& loads) {
  std::ranges::sort(loads, {}, &KeyLoad::key);
  std::size_t last = 0;
  for (std::size_t k = 1; k < loads.size(); ++k)
    if (loads[k].key == loads[last].key)
      loads[last].count += loads[k].count;
    else
      loads[++last] = loads[k];
  if (!loads.empty()) loads.resize(last + 1);
}

LiquidCut::Place by(const std::array<std::uint8_t, 3>& axes, const LiquidCut::Place& place) {
  return {place[axes[0]], place[axes[1]], place[axes[2]]};
}

}  // namespace

LiquidCut::Place LiquidCut::place_of(const Vec4f& x) const {
  Place place;
  constexpr float largest = static_cast<float>(kLargestPlace);
  for (int a = 0; a < 3; ++a)
    place[static_cast<std::size_t>(a)] =
        static_cast<std::int64_t>(std::clamp(std::floor(x[a] * (1 / width_)), -largest, largest));
  return place;
}

int LiquidCut::owner_of(const Place& place) const {
  const Part* part = parts_.data();
  while (part->rank < 0)
    part = by(part->axes, place) < by(part->axes, part->first) ? part + 1 : parts_.data() + part->beyond;
  return part->rank;
}

void LiquidCut::cut(std::span<const Vec4f> position, Ranks& ranks) {
  std::vector<std::uint64_t> keys(position.size());
  parallel_for(position.size(), [&](std::size_t i) { keys[i] = key_of(place_of(position[i])); });
  std::vector<KeyLoad> of_keys;
  for (const std::uint64_t key : keys) {
    if (of_keys.empty() || of_keys.back().key != key) of_keys.push_back({key, 0});
    ++of_keys.back().count;
  }
  merge(of_keys);
  of_keys = ranks.gathered(of_keys);
  merge(of_keys);
  std::vector<Load> loads;
  loads.reserve(of_keys.size());
  for (const KeyLoad& load : of_keys) loads.push_back({place_of_key(load.key), load.count});
  parts_.clear();
  halve(loads, 0, ranks.size());
}

/// Appends the part that these cells make for so many ranks, and what it is cut into.
void LiquidCut::halve(std::span<Load> loads, int first_rank, int ranks) {
  const std::size_t own = parts_.size();
  parts_.push_back({.rank = first_rank});
  if (ranks == 1) return;
  Place lower, extent;
  lower.fill(kLargestPlace);
  extent.fill(0);
  for (const Load& load : loads)
    for (std::size_t a = 0; a < 3; ++a) lower[a] = std::min(lower[a], load.place[a]);
  for (const Load& load : loads)
    for (std::size_t a = 0; a < 3; ++a) extent[a] = std::max(extent[a], load.place[a] - lower[a]);
  Part part{.axes = {0, 1, 2}, .rank = -1};
  std::ranges::stable_sort(part.axes, [&](std::uint8_t a, std::uint8_t b) { return extent[a] > extent[b]; });
  std::ranges::sort(loads, {}, [&](const Load& load) { return by(part.axes, load.place); });

  std::uint64_t all = 0, before = 0;
  for (const Load& load : loads) all += load.count;
  const int here = ranks / 2;
  const std::uint64_t wanted = all * static_cast<std::uint64_t>(here) / static_cast<std::uint64_t>(ranks);
  std::size_t cut = 0;  // a cell is on the side where its middle lies
  for (; cut < loads.size() && before + loads[cut].count / 2 < wanted; ++cut) before += loads[cut].count;
  part.first.fill(kLargestPlace + 1);  // nothing is beyond
  if (cut < loads.size()) part.first = loads[cut].place;
  halve(loads.first(cut), first_rank, here);
  part.beyond = static_cast<std::uint32_t>(parts_.size());
  halve(loads.subspan(cut), first_rank + here, ranks - here);
  parts_[own] = part;
}

}  // namespace kappaflow
