#include "solver/surface_tension.h"

#include <algorithm>
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
float cohesion(float q) {
  const float s = q * (1 - q), c = s * s * s;
  return (q > 0.5f ? c : 2 * c - 1 / 64.0f) / q;
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
    Vec4f sum = Vec4f::Zero();
    for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair) {
      const Vec4f d = inverse_support * (particles.position[i] - particles.position[lists.index[pair]]);
      sum += cohesion(std::max(d.norm(), 1e-6f)) * d;
    }
    particles.velocity[i] -= time_step * strength_ * sum;
  });
}

double capillary_time_step(double tension, double density, double spacing) {
  if (tension == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(density * spacing * spacing * spacing / (4 * std::numbers::pi * tension));
}

}  // namespace kappaflow
