#include "surface/field/stray_particles.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/cell_grid.h"
#include "core/space_cell.h"

namespace kappaflow {
namespace {

/// Cells whose size is the largest distance at which particles share a place in reach, with the weight in
/// each.
class CellWeights {
 public:
  CellWeights(std::span<const Vec3> position, std::span<const double> weight, double size) : size_(size) {
    cells_.reserve(position.size());
    for (std::size_t i = 0; i < position.size(); ++i)
      cells_.emplace_back(space_cell(position[i], size), std::max(weight[i], 0.0));
    std::ranges::sort(cells_);
    std::size_t last = 0;
    for (std::size_t c = 1; c < cells_.size(); ++c)
      if (cells_[c].first == cells_[last].first)
        cells_[last].second += cells_[c].second;
      else
        cells_[++last] = cells_[c];
    cells_.resize(last + 1);
  }

  /// Of x's cell and those around it.
  double around(const Vec3& x) const {
    const SpaceCell at = space_cell(x, size_);
    double sum = 0;
    for (int n = 0; n < 9; ++n) {
      const SpaceCell first{at[0] + n / 3 - 1, at[1] + n % 3 - 1, at[2] - 1};
      for (auto cell = std::ranges::lower_bound(cells_, first, {}, [](const auto& c) { return c.first; });
           cell != cells_.end() && cell->first <= SpaceCell{first[0], first[1], first[2] + 2}; ++cell)
        sum += cell->second;
    }
    return sum;
  }

 private:
  double size_;
  std::vector<std::pair<SpaceCell, double>> cells_;  // ascending
};

bool are_far_apart(std::span<const Vec3> position, double reach) {
  Vec3 lower = position[0], upper = lower;
  for (const Vec3& x : position) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  return cell_counts(upper - lower, reach, position.size()).cell_size > reach;
}

}  // namespace

std::vector<std::uint32_t> without_strays(std::span<const Vec3> position, std::span<const double> reach,
                                          std::span<const double> weight, double threshold) {
  std::vector<std::uint32_t> kept(position.size());
  std::iota(kept.begin(), kept.end(), 0u);
  if (position.empty()) return kept;
  const double largest = *std::ranges::max_element(reach);
  if (!are_far_apart(position, largest)) return kept;
  const CellWeights weights(position, weight, 2 * largest);
  std::erase_if(kept, [&](std::uint32_t i) { return weights.around(position[i]) < threshold; });
  return kept;
}

}  // namespace kappaflow
