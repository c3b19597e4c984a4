#include "solver/particle_shift.h"

#include <algorithm>

#include "core/parallel.h"
#include "solver/kernel.h"
#include "solver/lanes.h"
#include "solver/shear_rate.h"

namespace kappaflow {
namespace {

// By validate-rising-drop, a drop of a quarter of the density of what is around it: 0.82 to 0.95 of its
// speed, without shifts 0.6, and ever slower. With twice as much its particles lag behind its velocity, with
// half it slows.
constexpr float kShift = 5;
// Of what the step shears: what is sheared more is no creeping flow, and shifts are explicit.
constexpr float kLargestStrain = 0.02f;
// Of a shift, over that [spacings].
constexpr float kLargestShift = 2;
// Relative densities of particles near a free surface, which are not moved, and of those within the liquid: a
// plane surface of a lattice has 0.85, disorder within liquid makes 0.96 at least.
constexpr float kFreeSurface = 0.9f, kWithin = 0.97f;
// Of viscosity * longest step / spacing^2: below it particles find their places by themselves.
constexpr double kThin = 0.2;

}  // namespace

ParticleShift::ParticleShift(const FluidOptions& options)
    : spacing_(static_cast<float>(options.spacing)),
      needed_(options.largest_density() > options.least_density()) {
  for (std::size_t fluid = 0; fluid < options.fluids(); ++fluid)
    is_thin_.push_back(options.viscosity(fluid) * options.max_time_step <
                       kThin * options.spacing * options.spacing);
  needed_ = needed_ && std::ranges::count(is_thin_, 0) > 0;
}

/// How much the step shears the liquid there, 0 of a particle that stays.
float ParticleShift::strain(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                            const WallSums& walls, float time_step) const {
  if (particles.led_by[i] != 0 || is_thin_[particles.fluid[i]] || walls.touches(i)) return 0;
  const float within =
      std::clamp((particles.density[i] - kFreeSurface) / (kWithin - kFreeSurface), 0.0f, 1.0f);
  if (!(within > 0)) return 0;
  const float strain = time_step * shear_rate(i, particles, lists, walls, particles.velocity, spacing_, 1);
  return within * std::min(strain, kLargestStrain);
}

void ParticleShift::apply(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                          float time_step) const {
  std::vector<Vec4f>& shift = particles.scratch[0];
  shift.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    const float own = strain(i, particles, lists, walls, time_step);
    shift[i].setZero();
    if (!(own > 0)) return;
    const Vec4f xi = particles.position[i];
    Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
    for (const PairBlock& block : lists.of(i)) {
      const WideVec xj = gather(particles.position, block);
      const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
      const Wide q = (x * x + y * y + z * z).sqrt() * (1 / spacing_);
      const Wide scale = lists.factor(block) * crowding(q);
      sum_x += scale * x;
      sum_y += scale * y;
      sum_z += scale * z;
    }
    const Vec4f away = -kShift * spacing_ * sums(sum_x, sum_y, sum_z);
    shift[i] = own * spacing_ * std::min(1.0f, kLargestShift / away.norm()) * away;
  });
  parallel_for(particles.size(), [&](std::size_t i) { particles.position[i] += shift[i]; });
}

}  // namespace kappaflow
