#include "solver/surface_tension.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.h"

namespace kappaflow {
namespace {

/// int_0^1 q^4 C(q) dq.
constexpr double kMoment = 1 / 1320.0 + (1 / 2048.0 - 1 / 1536.0 + 3 / 10240.0 - 1 / 22528.0) - 1 / 10240.0;

/// What the drop's oscillation has over Fowler's formula.
constexpr double kStructure = 1;

/// C(q) / q.
Wide cohesion(const Wide& q) {
  const Wide s = q * (1 - q).max(0.0f), c = s * s * s;
  return (q > 0.5f).select(c, 2 * c - 1 / 64.0f) / q;
}

}  // namespace

SurfaceTension::SurfaceTension(const FluidOptions& options)
    : support_(static_cast<float>(2 * options.spacing)) {
  const double support = 2 * options.spacing, volume = std::pow(options.spacing, 3);
  strength_ =
      static_cast<float>(8 * volume * options.surface_tension /
                         (std::numbers::pi * kStructure * options.density * kMoment * std::pow(support, 5)));
}

void SurfaceTension::apply(FluidParticles& particles, const NeighbourLists& lists, float time_step) const {
  if (strength_ == 0) return;
  const float inverse_support = 1 / support_;
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] != 0) return;
    const Vec4f xi = particles.position[i];
    Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
    for (const PairBlock& block : lists.of(i)) {
      const WideVec xj = gather(particles.position.data(), block.index.data());
      const Wide x = inverse_support * (xi[0] - xj.x), y = inverse_support * (xi[1] - xj.y),
                 z = inverse_support * (xi[2] - xj.z);
      const Wide pull = cohesion((x * x + y * y + z * z).sqrt().max(1e-6f));
      sum_x += pull * x;
      sum_y += pull * y;
      sum_z += pull * z;
    }
    const Vec4f sum(sum_x.sum(), sum_y.sum(), sum_z.sum(), 0);
    particles.velocity[i] -= time_step * strength_ * sum;
  });
}

double capillary_time_step(double tension, double density, double spacing) {
  if (tension == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(density * spacing * spacing * spacing / (4 * std::numbers::pi * tension));
}

}  // namespace kappaflow
