// Which rank holds which part of space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "solver/ranks.h"

namespace kappaflow {

/// Space is cut along a Morton curve through cubic cells of a lattice that never moves, four spacings wide as
/// those of the viscous preconditioner (RigidMultigrid), so that each of these has one owner too. A rank owns
/// the cells between two keys. The cut is made anew whenever particles have moved, of where they are and
/// nothing else: a run that is resumed has the same one. That costs one gather of the cells that hold liquid,
/// 1/64 of the particles, and no particle changes its rank but where the liquid has moved.
class LiquidCut {
 public:
  using Place = std::array<std::int64_t, 3>;
  static constexpr double kCellWidth = 4;  // [spacings]
  static constexpr std::int64_t kLargestPlace = (std::int64_t{1} << 20) - 1;

  explicit LiquidCut(double spacing) : width_(static_cast<float>(kCellWidth * spacing)) {}

  /// Of the cell that holds x; what is too far away for a key is in the last one. Ascends with x, whatever
  /// the rounding.
  Place place_of(const Vec4f& x) const;
  int owner_of(const Place& place) const;

  /// Shares the particles of all ranks evenly, as cells allow.
  void cut(std::span<const Vec4f> position, Ranks& ranks);

 private:
  static std::uint64_t key_of(const Place& place);

  float width_;                       // [m]
  std::vector<std::uint64_t> first_;  // key of each rank but the first
};

}  // namespace kappaflow
