#include "solver/surface_tension.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/lanes.h"

namespace kappaflow {
namespace {

// The shares of the two energies: the smallest cohesion with which a drop at rest loses no particles, and
// with that the area's such that an oscillating drop has its period.
constexpr double kArea = 1;
constexpr double kCohesion = 0.2;
/// eps, below which n is the disorder of particles within the liquid, in 1/spacing.
constexpr double kLeastGradient = 0.2;
/// int_0^1 q^4 C(q) dq.
constexpr double kMoment = 1 / 1320.0 + (1 / 2048.0 - 1 / 1536.0 + 3 / 10240.0 - 1 / 22528.0) - 1 / 10240.0;
/// Smaller distances are taken for this one, in supports.
constexpr float kLeastDistance = 1e-4f;

/// C(q) / q.
Wide cohesion(const Wide& q) {
  const Wide cube = (q * (1 - q)).cube();
  return (q > 0.5f).select(cube, 2 * cube - 1 / 64.0f) / q;
}

}  // namespace

SurfaceTension::SurfaceTension(const FluidOptions& options)
    : inverse_support_(static_cast<float>(0.5 / options.spacing)),
      least_gradient_(static_cast<float>(kLeastGradient / options.spacing)) {
  const double support = 2 * options.spacing;
  const double unit = options.surface_tension / (options.density * std::numbers::pi * support * support);
  area_strength_ = static_cast<float>(kArea * unit);
  cohesion_strength_ = static_cast<float>(kCohesion * unit / kMoment);
}

Vec4f SurfaceTension::acceleration(std::size_t i, const FluidParticles& particles,
                                   const NeighbourLists& lists) const {
  const Vec4f xi = particles.position[i], mi = particles.scratch[0][i];
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const WideVec mj = gather(particles.scratch[0], block);
    const Wide x = inverse_support_ * (xi[0] - xj.x), y = inverse_support_ * (xi[1] - xj.y),
               z = inverse_support_ * (xi[2] - xj.z);
    const Wide q = (x * x + y * y + z * z).sqrt().max(kLeastDistance);
    const Wide mx = mi[0] - mj.x, my = mi[1] - mj.y, mz = mi[2] - mj.z;
    // grad grad W = a I + b x x^T, with W'' and W' / q of the cubic spline in units of its norm.
    const Wide outer = (1 - q).max(0.0f), inner = (0.5f - q).max(0.0f);
    const Wide first = -6 * (outer.square() - 4 * inner.square()) / q, second = 12 * outer - 48 * inner;
    const Wide across = block.present() * area_strength_ * first;
    const Wide along =
        block.present() * (area_strength_ * (second - first) / q.square() * (x * mx + y * my + z * mz) +
                           cohesion_strength_ * cohesion(q));
    sum_x += across * mx + along * x;
    sum_y += across * my + along * y;
    sum_z += across * mz + along * z;
  }
  return sums(sum_x, sum_y, sum_z) / -particles.mass(i);
}

void SurfaceTension::apply(FluidParticles& particles, const NeighbourLists& lists, float time_step) const {
  if (area_strength_ == 0) return;
  std::vector<Vec4f>& direction = particles.scratch[0];
  direction.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    const Vec4f& n = particles.gradient_sum[i];
    direction[i] = n / std::sqrt(n.squaredNorm() + least_gradient_ * least_gradient_);
  });
  fill_ghosts(particles, direction);
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] == 0) particles.velocity[i] += time_step * acceleration(i, particles, lists);
  });
}

double capillary_time_step(double tension, double density, double spacing) {
  if (tension == 0) return std::numeric_limits<double>::infinity();
  return std::sqrt(density * spacing * spacing * spacing / (4 * std::numbers::pi * tension));
}

}  // namespace kappaflow
