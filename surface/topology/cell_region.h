// Sets of a lattice's cells: those around places where mesh and surface disagree.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// Cells of a lattice, by the index of their lower corner; not bounded by the lattice's size.
using LatticeCell = std::array<int, 3>;

/// The largest index of a cell, up or down: differences of two, and some more, are int.
inline constexpr int kFarthestCell = 1 << 29;

/// The cell that holds this one, of a lattice that is so many times as coarse.
inline LatticeCell coarser(const LatticeCell& cell, int times) {
  LatticeCell result;
  for (int a = 0; a < 3; ++a) result[a] = (cell[a] >= 0 ? cell[a] : cell[a] - times + 1) / times;
  return result;
}

inline bool has(const LatticeBlock& block, const LatticeCell& cell) {
  for (int a = 0; a < 3; ++a)
    if (cell[a] < block.first[a] || cell[a] > block.last[a]) return false;
  return true;
}

/// Some cells and all that are up to `growth` away from one of them along each axis.
class CellRegion {
 public:
  CellRegion(std::span<const LatticeCell> cells, int growth) : first_(cells[0]) {
    LatticeCell last = first_;
    for (const LatticeCell& c : cells)
      for (int a = 0; a < 3; ++a) {
        first_[a] = std::min(first_[a], c[a] - growth);
        last[a] = std::max(last[a], c[a] + growth);
      }
    for (int a = 0; a < 3; ++a) dims_[a] = last[a] - first_[a] + 1;
    if (too_large()) return;
    in_.assign(static_cast<std::size_t>(dims_[0]) * dims_[1] * dims_[2], 0);
    for (const LatticeCell& c : cells) in_[index(c)] = 1;
    std::size_t stride = 1;
    for (int a = 0; a < 3; ++a) {
      grow(stride, dims_[a], growth);
      stride *= dims_[a];
    }
  }

  /// Whether its box has more cells than memory should be spent on; it is empty then.
  bool too_large() const { return 1.0 * dims_[0] * dims_[1] * dims_[2] > kMostCells; }
  bool has(const LatticeCell& c) const {
    for (int a = 0; a < 3; ++a)
      if (c[a] < first_[a] || c[a] >= first_[a] + dims_[a]) return false;
    return in_[index(c)] != 0;
  }
  LatticeBlock block() const {
    return {first_, {first_[0] + dims_[0], first_[1] + dims_[1], first_[2] + dims_[2]}};
  }

 private:
  static constexpr double kMostCells = 67108864;  // 2^26: 64 MiB

  std::size_t index(const LatticeCell& c) const {
    return c[0] - first_[0] +
           static_cast<std::size_t>(dims_[0]) *
               (c[1] - first_[1] + static_cast<std::size_t>(dims_[1]) * (c[2] - first_[2]));
  }

  /// Along one axis, on which neighbours are `stride` apart.
  void grow(std::size_t stride, int dim, int growth) {
    for (std::size_t at = 0; at < in_.size(); ++at) {
      if (at / stride % dim != 0) continue;  // of each line its first cell
      row_.assign(dim, 0);
      for (int i = 0; i < dim; ++i)
        if (in_[at + i * stride])
          std::fill(row_.begin() + std::max(0, i - growth), row_.begin() + std::min(dim, i + growth + 1), 1);
      for (int i = 0; i < dim; ++i) in_[at + i * stride] = row_[i];
    }
  }

  LatticeCell first_;
  std::array<int, 3> dims_{};
  std::vector<char> in_, row_;
};

}  // namespace kappaflow
