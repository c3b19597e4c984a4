#include "surface/measure/particle_means.h"

#include "core/cell_grid.h"
#include "core/parallel.h"

namespace kappaflow {

std::vector<double> particle_means(std::span<const Vec3> points, std::span<const Vec3> position,
                                   std::span<const float> value, double sigma, double fallback) {
  CellGrid grid;
  grid.build(position, sigma);
  const auto order = grid.order();
  std::vector<double> result(points.size());
  parallel_for(points.size(), [&](std::size_t p) {
    double weight = 0, sum = 0;
    grid.ranges_near(points[p], sigma, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k) {
        const double s = 1 - (position[order[k]] - points[p]).squaredNorm() / (sigma * sigma);
        if (s <= 0) continue;
        weight += s * s * s;
        sum += s * s * s * static_cast<double>(value[order[k]]);
      }
    });
    result[p] = weight > 0 ? sum / weight : fallback;
  });
  return result;
}

}  // namespace kappaflow
