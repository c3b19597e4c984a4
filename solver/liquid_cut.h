// Which rank holds which part of space.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "solver/ranks.h"

namespace kappaflow {

/// Recursive bisection (Berger & Bokhari, "A partitioning strategy for nonuniform problems on
/// multiprocessors", 1987) of cubic cells of a lattice that never moves, four spacings wide as those of the
/// viscous preconditioner (RigidMultigrid), so that each of these has one owner too. A plane across the
/// longest extent halves the ranks and, to a cell, the particles: where it goes through a layer of cells,
/// that is cut along the next extent. Planes leave ranks fewer neighbours' particles than a space-filling
/// curve: of a slab on two ranks 4 percent, not 31. The cut is made anew whenever particles have moved, of
/// where they are and nothing else: a run that is resumed has the same one. That costs one gather of the
/// cells that hold liquid, 1/64 of the particles, and no particle changes its rank but where the liquid has
/// moved.
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
  /// A cell and the particles in it.
  struct Load {
    Place place{};
    std::uint64_t count = 0;
  };
  /// A cut in two, or what is left for one rank.
  struct Part {
    std::array<std::uint8_t, 3> axes{};  // from the longest extent of the part to the shortest
    Place first{};                       // of the cells beyond the cut, which are ordered by these axes
    std::uint32_t beyond = 0;            // part there; that on this side follows this one
    int rank = 0;                        // its only one; -1: it is cut
  };

  void halve(std::span<Load> loads, int first_rank, int ranks);

  float width_;  // [m]
  std::vector<Part> parts_;
};

}  // namespace kappaflow
