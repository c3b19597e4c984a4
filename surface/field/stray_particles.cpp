#include "surface/field/stray_particles.h"

#include <algorithm>
#include <utility>

#include "core/cell_grid.h"
#include "core/space_cell.h"

namespace kappaflow {
namespace {

/// Cells whose size is the largest distance at which particles share a place in reach, with the weight in
/// each.
class CellWeights {
 public:
  CellWeights(const FieldParticles& particles, double size) : size_(size) {
    cells_.reserve(particles.position.size());
    for (std::size_t i = 0; i < particles.position.size(); ++i)
      cells_.emplace_back(space_cell(particles.position[i], size), std::max(particles.weight[i], 0.0));
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

bool are_far_apart(const FieldParticles& particles, double sigma) {
  Vec3 lower = particles.position[0], upper = lower;
  for (const Vec3& x : particles.position) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  return cell_counts(upper - lower, sigma, particles.position.size()).cell_size > sigma;
}

}  // namespace

std::optional<FieldParticles> without_strays(const FieldParticles& particles, double threshold) {
  if (particles.position.empty()) return std::nullopt;
  const double sigma = *std::ranges::max_element(particles.sigma);
  if (!are_far_apart(particles, sigma)) return std::nullopt;
  const CellWeights weights(particles, 2 * sigma);
  FieldParticles kept;
  kept.cloud_speed = particles.cloud_speed;
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    if (weights.around(particles.position[i]) < threshold) continue;
    kept.position.push_back(particles.position[i]);
    kept.velocity.push_back(particles.velocity[i]);
    kept.sigma.push_back(particles.sigma[i]);
    kept.weight.push_back(particles.weight[i]);
    kept.weight_rate.push_back(particles.weight_rate[i]);
  }
  return kept;
}

}  // namespace kappaflow
