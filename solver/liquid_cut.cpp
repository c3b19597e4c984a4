#include "solver/liquid_cut.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/parallel.h"
#include "solver/rigid_level.h"
#include "solver/rigid_multigrid.h"

namespace kappaflow {
namespace {

static_assert(LiquidCut::kCellWidth == RigidMultigrid::kCellWidth);

std::uint64_t key_of(const LiquidCut::Place& place) {
  constexpr std::int64_t largest = LiquidCut::kLargestPlace;
  return RigidLevel::key_of({place[0] + largest, place[1] + largest, place[2] + largest});
}

LiquidCut::Place place_of_key(std::uint64_t key) {
  LiquidCut::Place place = RigidLevel::place_of(key);
  for (std::int64_t& along : place) along -= LiquidCut::kLargestPlace;
  return place;
}

/// Sorts so that what is of the same place in the order is next to each other, and adds that up.
template <class T, class Key>
void merge(std::vector<T>& loads, const Key& key) {
  std::ranges::sort(loads, {}, key);
  std::size_t last = 0;
  for (std::size_t k = 1; k < loads.size(); ++k)
    if (key(loads[k]) == key(loads[last]))
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
  while (part->ranks > 1) part = &parts_[part->side_of(place)];
  return part->rank;
}

/// The part of this one that holds a place.
std::uint32_t LiquidCut::Part::side_of(const Place& place) const {
  return by(axes, place) < by(axes, first) ? side : side + 1;
}

void LiquidCut::cut(std::span<const Vec4f> position, Ranks& ranks) {
  std::vector<std::uint64_t> keys(position.size());
  parallel_for(position.size(), [&](std::size_t i) { keys[i] = key_of(place_of(position[i])); });
  std::vector<Load> loads;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i] != keys[i - 1]) loads.push_back({place_of_key(keys[i])});
    ++loads.back().count;
  }
  merge(loads, [](const Load& load) { return load.place; });
  parts_.assign(1, {.ranks = ranks.size()});
  const auto is_cut = [](const Part& part) { return part.ranks > 1; };
  for (std::size_t begin = 0; std::ranges::any_of(std::span(parts_).subspan(begin), is_cut);) {
    const std::size_t end = parts_.size();
    std::vector<std::uint64_t> wanted = find_axes(begin, loads, ranks);
    for (std::size_t k = 0; k < 3; ++k) find_first(begin, k, loads, wanted, ranks);
    for (std::size_t p = begin; p < end; ++p) split(p);
    for (Load& load : loads)
      if (load.part >= begin && is_cut(parts_[load.part])) load.part = parts_[load.part].side_of(load.place);
    begin = end;
  }
}

/// Sets the axes of the parts from `begin` on. Returns of each how many particles are to be on this side.
std::vector<std::uint64_t> LiquidCut::find_axes(std::size_t begin, std::span<const Load> loads,
                                                Ranks& ranks) {
  struct Extent {
    Place lower{kLargestPlace, kLargestPlace, kLargestPlace};
    Place upper{-kLargestPlace, -kLargestPlace, -kLargestPlace};
    std::uint64_t count = 0;
    std::uint32_t part = 0;

    void add(const Place& low, const Place& high, std::uint64_t particles) {
      for (std::size_t a = 0; a < 3; ++a) {
        lower[a] = std::min(lower[a], low[a]);
        upper[a] = std::max(upper[a], high[a]);
      }
      count += particles;
    }
  };
  std::vector<Extent> extents(parts_.size() - begin), own;
  for (const Load& load : loads)
    if (load.part >= begin) extents[load.part - begin].add(load.place, load.place, load.count);
  for (std::uint32_t p = 0; p < extents.size(); ++p) {
    extents[p].part = p;
    if (extents[p].count > 0) own.push_back(extents[p]);
  }
  std::ranges::fill(extents, Extent());
  for (const Extent& part : ranks.gathered(own)) extents[part.part].add(part.lower, part.upper, part.count);

  std::vector<std::uint64_t> wanted;
  for (std::size_t p = 0; p < extents.size(); ++p) {
    Part& part = parts_[begin + p];
    std::ranges::stable_sort(part.axes, std::greater(),
                             [&](std::uint8_t a) { return extents[p].upper[a] - extents[p].lower[a]; });
    const double here = ranks.share_of(part.rank, part.ranks / 2),
                 all = ranks.share_of(part.rank, part.ranks);
    wanted.push_back(static_cast<std::uint64_t>(static_cast<double>(extents[p].count) * here / all));
  }
  return wanted;
}

/// Of the parts from `begin` on, finds along the k-th of their axes where the cell is that holds the last of
/// the particles wanted, in the layer, the row of it, where those along the axes before are; those that come
/// before are wanted no more.
void LiquidCut::find_first(std::size_t begin, std::size_t k, std::span<const Load> loads,
                           std::vector<std::uint64_t>& wanted, Ranks& ranks) {
  struct Layer {
    std::uint32_t part = 0;
    std::int64_t at = 0;
    std::uint64_t count = 0;
  };
  const auto order = [](const Layer& layer) { return std::pair(layer.part, layer.at); };
  std::vector<Layer> layers;
  for (const Load& load : loads) {
    if (load.part < begin || parts_[load.part].ranks == 1) continue;
    const Place place = by(parts_[load.part].axes, load.place),
                first = by(parts_[load.part].axes, parts_[load.part].first);
    if (std::equal(place.begin(), place.begin() + k, first.begin()))
      layers.push_back({load.part, place[k], load.count});
  }
  merge(layers, order);
  layers = ranks.gathered(layers);
  merge(layers, order);
  std::vector<char> found(wanted.size(), 0);
  for (const Layer& layer : layers) {
    std::uint64_t& left = wanted[layer.part - begin];
    if (found[layer.part - begin] != 0) continue;
    if (layer.count < left) {
      left -= layer.count;
      continue;
    }
    found[layer.part - begin] = 1;
    Part& part = parts_[layer.part];
    // A cell is on the side where its middle lies.
    part.first[part.axes[k]] = layer.at + (k == 2 && layer.count / 2 < left ? 1 : 0);
  }
}

/// Appends what the part is cut into, if it is.
void LiquidCut::split(std::size_t p) {
  const int rank = parts_[p].rank, all = parts_[p].ranks, here = all / 2;
  if (all == 1) return;
  parts_[p].side = static_cast<std::uint32_t>(parts_.size());
  parts_.push_back({.rank = rank, .ranks = here});
  parts_.push_back({.rank = rank + here, .ranks = all - here});
}

}  // namespace kappaflow
