#include "tools/runs/liquid_metrics.h"

#include <algorithm>

#include "core/parallel.h"

namespace kappaflow {

double penetration_max(std::span<const Vec3> position, const WallDistance& walls, double spacing) {
  return parallel_max(position.size(), 0.0, [&](std::size_t i) { return walls.depth(position[i]); }) /
         spacing;
}

Compression compression(std::span<const float> density, std::span<const std::uint8_t> fluid,
                        const FluidOptions& options) {
  const std::size_t n = density.size();
  if (n == 0) return {};
  const auto of = [&](std::size_t i) {
    return std::max(static_cast<double>(density[i]) / options.rest_density(fluid[i]) - 1, 0.0);
  };
  return {parallel_sum(n, 0.0, of) / static_cast<double>(n), parallel_max(n, 0.0, of)};
}

}  // namespace kappaflow
