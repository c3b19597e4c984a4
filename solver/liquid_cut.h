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
/// longest extent halves the ranks and divides, to a cell, the particles as Ranks::share_of() those on either
/// side: where it goes through a layer of cells, that is cut along the next extent. Planes leave ranks fewer
/// neighbours' particles than a space-filling curve: of a slab on two ranks 4 percent, not 31. The cut is
/// made anew whenever particles have moved, of where they are and the shares, of nothing that is measured
/// meanwhile: a run that is resumed has the same one. No particle changes its rank but where the liquid has
/// moved. Ranks tell each other of the particles in each layer of cells across an axis, then in each row of
/// the layer that is cut, then in each cell of the row, for all parts of one level of the bisection at once.
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

  /// Divides the particles of all ranks by their shares, as cells allow.
  void cut(std::span<const Vec4f> position, Ranks& ranks);

 private:
  /// A cell, this rank's particles in it, and the part where it is.
  struct Load {
    Place place{};
    std::uint64_t count = 0;
    std::uint32_t part = 0;
  };
  /// What so many ranks share, from `rank` on.
  struct Part {
    int rank = 0, ranks = 1;
    std::array<std::uint8_t, 3> axes{0, 1, 2};  // from the longest extent to the shortest
    // Of the cells beyond the cut, which are ordered by these axes. Where there is no liquid, none is.
    Place first{kLargestPlace + 1, kLargestPlace + 1, kLargestPlace + 1};
    std::uint32_t side = 0;  // part on this side of the cut; that beyond follows it

    std::uint32_t side_of(const Place& place) const;
  };

  std::vector<std::uint64_t> find_axes(std::size_t begin, std::span<const Load> loads, Ranks& ranks);
  void find_first(std::size_t begin, std::size_t k, std::span<const Load> loads,
                  std::vector<std::uint64_t>& wanted, Ranks& ranks);
  void split(std::size_t p);

  float width_;              // [m]
  std::vector<Part> parts_;  // level by level
};

}  // namespace kappaflow
