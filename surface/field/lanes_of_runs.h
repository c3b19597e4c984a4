// Loops over the runs of a grid's cell order, some at a time. Arrays have kWide entries more than there are
// points: the last lanes of a run may be of other cells, and are left out.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/wide.h"
#include "surface/field/particle_hits.h"

namespace kappaflow {

/// Appends to `hit`, which holds `count` already, those k of [begin, end) whose value is below 1; returns the
/// new count. values(k): those of k to k + 7. There is room for kWide more.
template <class Values>
std::size_t append_below_one(std::uint32_t begin, std::uint32_t end, std::uint32_t* hit, std::size_t count,
                             const Values& values) {
  for (std::uint32_t k = begin; k < end; k += kWide) {
    const unsigned within = end - k < kWide ? (1u << (end - k)) - 1 : ~0u;
    const unsigned lanes = lanes_below(values(k), 1) & within;
    pack(indices_from(k), lanes, hit + count);
    count += static_cast<std::size_t>(std::popcount(lanes));
  }
  return count;
}

/// Calls add(k, kept) for [begin, end), four from k on at a time; kept(u) is u, zero in lanes beyond the end.
template <class Add>
void add_in_fours(std::uint32_t begin, std::uint32_t end, const Add& add) {
  using Lanes = ParticleHits::Lanes;
  constexpr std::uint32_t kLanes = ParticleHits::kLanes;
  std::uint32_t k = begin;
  for (; k + kLanes <= end; k += kLanes) add(k, [](const Lanes& u) { return u; });
  if (k < end)
    add(k, [&](const Lanes& u) -> Lanes {
      return u * (Lanes(0, 1, 2, 3) < static_cast<double>(end - k)).template cast<double>();
    });
}

}  // namespace kappaflow
