#include "solver/liquid_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "solver/rigid_level.h"
#include "solver/rigid_multigrid.h"

namespace kappaflow {
namespace {

static_assert(LiquidCut::kCellWidth == RigidMultigrid::kCellWidth);

/// Particles in a cell.
struct Load {
  std::uint64_t key = 0, count = 0;
};

/// One entry a key, ascending.
void merge(std::vector<Load>& loads) {
  std::ranges::sort(loads, {}, &Load::key);
  std::size_t last = 0;
  for (std::size_t k = 1; k < loads.size(); ++k)
    if (loads[k].key == loads[last].key)
      loads[last].count += loads[k].count;
    else
      loads[++last] = loads[k];
  if (!loads.empty()) loads.resize(last + 1);
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

std::uint64_t LiquidCut::key_of(const Place& place) {
  return RigidLevel::key_of({place[0] + kLargestPlace, place[1] + kLargestPlace, place[2] + kLargestPlace});
}

int LiquidCut::owner_of(const Place& place) const {
  return static_cast<int>(std::ranges::upper_bound(first_, key_of(place)) - first_.begin());
}

void LiquidCut::cut(std::span<const Vec4f> position, Ranks& ranks) {
  std::vector<std::uint64_t> keys(position.size());
  parallel_for(position.size(), [&](std::size_t i) { keys[i] = key_of(place_of(position[i])); });
  std::vector<Load> loads;
  for (const std::uint64_t key : keys) {
    if (loads.empty() || loads.back().key != key) loads.push_back({key, 0});
    ++loads.back().count;
  }
  merge(loads);
  loads = ranks.gathered(loads);
  merge(loads);
  std::uint64_t all = 0, before = 0;
  for (const Load& load : loads) all += load.count;
  const auto size = static_cast<std::uint64_t>(ranks.size());
  first_.assign(size - 1, std::numeric_limits<std::uint64_t>::max());
  std::uint64_t last = 0;
  for (const Load& load : loads) {  // to the rank in whose share its middle lies
    const std::uint64_t owner = std::min(size - 1, (2 * before + load.count) * size / (2 * all));
    for (; last < owner; ++last) first_[last] = load.key;
    before += load.count;
  }
}

}  // namespace kappaflow
