#include "solver/viscous_pressure.h"

#include <algorithm>
#include <atomic>

#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/lanes.h"
#include "solver/pressure.h"

namespace kappaflow {
namespace {

// Of a liquid whose two coefficients of viscosity are equal: 5/3, the second and two thirds of the first.
constexpr double kBulk = 5.0 / 3;
// From here on liquid is thick: viscosity * longest step / spacing^2.
constexpr double kThick = 36;
// Up to here the pressure takes the whole correction in one step, beyond in several: what the viscous solve
// leaves unsolved would count as compression.
constexpr double kMostThick = 100;
// With fewer neighbours a particle is loose. Rows of single particles carry no tension; and two or three that
// pulled at each other alone would fall into a point, where nothing tells them from dense liquid.
constexpr float kLeastNeighbours = 6;
// Smallest share with which a thread of four particles across can be drawn out to a quarter of its section.
constexpr float kSpread = 0.01f;

bool is_loose(std::size_t i, const NeighbourLists& lists) {
  float sum = 0;
  for (const PairBlock& block : lists.of(i))
    if ((sum += block.present().sum()) >= kLeastNeighbours) return false;
  return true;
}

/// By particle: kBulk nu D v [m2/s2], and whether it may pull, 1 or 0. Before, D v itself.
std::vector<Vec4f>& noted(FluidParticles& particles) {
  return compression_rates(particles);
}

}  // namespace

bool is_thick(double viscosity, const FluidOptions& options) {
  return viscosity * options.max_time_step >= kThick * options.spacing * options.spacing;
}

ViscousPressure::ViscousPressure(const FluidOptions& options)
    : spacing_(static_cast<float>(options.spacing)) {
  for (std::size_t fluid = 0; fluid < options.fluids(); ++fluid) {
    // Whether liquid whose viscosity depends on its temperature is thick, its particles say.
    const bool may_be = has_temperature_law(options.temperature_law(fluid));
    const double viscosity = options.viscosity(fluid),
                 unit = options.spacing * options.spacing / options.max_time_step;
    const bool thick = may_be || is_thick(viscosity, options);
    needed_ = needed_ || thick;
    const double most = may_be ? kMostThick * unit : std::min(viscosity, kMostThick * unit);
    const double scale = kBulk * options.relative_mass(fluid);
    resistance_.push_back(thick ? static_cast<float>(scale * most) : 0);
    least_.push_back(may_be ? static_cast<float>(scale * kThick * unit) : 0);
  }
}

void ViscousPressure::spread(FluidParticles& particles, const NeighbourLists& lists, float time_step) const {
  parallel_for(particles.size(),
               [&](std::size_t i) { particles.position[i][3] = -particles.least_pressure[i]; });
  fill_kappa_of_ghosts(particles);
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] != 0) return;
    const Vec4f xi = particles.position[i];
    Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
    for (const PairBlock& block : lists.of(i)) {
      const WideVec xj = gather(particles.position, block);
      const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
      const Wide q = (x * x + y * y + z * z).sqrt() * (1 / spacing_);
      const Wide scale = lists.factor(block) * (xi[3] + xj.w) * crowding(q);
      sum_x += scale * x;
      sum_y += scale * y;
      sum_z += scale * z;
    }
    particles.velocity[i] -= time_step * kSpread / particles.mass(i) * sums(sum_x, sum_y, sum_z);
  });
}

float ViscousPressure::resistance(std::size_t i, const FluidParticles& particles) const {
  const float at_rest = resistance_[particles.fluid[i]];
  if (particles.viscosity.empty()) return at_rest;
  const float own = std::min(at_rest, static_cast<float>(kBulk) * particles.viscosity[i]);
  return own < least_[particles.fluid[i]] ? 0 : own;
}

void ViscousPressure::measure(FluidParticles& particles, const NeighbourLists& lists,
                              const WallSums& walls) const {
  auto& notes = noted(particles);
  parallel_for(particles.size(), [&](std::size_t i) {
    const bool thick = resistance(i, particles) > 0;
    const bool free = thick && particles.led_by[i] == 0 && !walls.touches(i);
    const float correction = free ? resistance(i, particles) * notes[i][0] : 0;
    notes[i] = {correction, free ? 1.0f : 0.0f, 0, 0};
  });
  // Thin liquid gives way at once: beside it, compression says nothing of the pressure in the thick one.
  const auto forget = [&](std::size_t i, bool correction_too) {
    std::atomic_ref(notes[i][1]).store(0, std::memory_order_relaxed);
    if (correction_too) std::atomic_ref(notes[i][0]).store(0, std::memory_order_relaxed);
  };
  parallel_for(particles.size(), [&](std::size_t i) {
    const bool thin = resistance(i, particles) == 0;
    if (!thin && !is_loose(i, lists)) return;
    forget(i, thin);
    for (const PairBlock& block : lists.of(i))
      for (std::size_t k = 0; k < kWide; ++k)
        if (block.factor[k] > 0 && block.base + block.offset[k] < particles.size())
          forget(block.base + block.offset[k], thin);
  });
  if (particles.halo != nullptr) forget_beside_ghosts(particles, lists);
}

/// What the other ranks' thin and loose particles do to this one's beside them.
void ViscousPressure::forget_beside_ghosts(FluidParticles& particles, const NeighbourLists& lists) const {
  enum : std::uint8_t { kThinOne = 1, kLooseOne = 2 };
  auto& notes = noted(particles);
  const std::size_t n = particles.size();
  std::vector<std::uint8_t> kinds(n);
  parallel_for(n, [&](std::size_t i) {
    kinds[i] = static_cast<std::uint8_t>((resistance(i, particles) == 0 ? kThinOne : 0) |
                                         (is_loose(i, lists) ? kLooseOne : 0));
  });
  fill_ghosts(particles, kinds);
  parallel_for(n, [&](std::size_t i) {
    for (const PairBlock& block : lists.of(i))
      for (std::size_t k = 0; k < kWide; ++k) {
        const std::size_t j = block.base + block.offset[k];
        if (block.factor[k] == 0 || j < n) continue;
        if (kinds[j] != 0) notes[i][1] = 0;
        if ((kinds[j] & kThinOne) != 0) notes[i][0] = 0;
      }
  });
}

void ViscousPressure::correct(FluidParticles& particles) const {
  const auto& notes = noted(particles);
  parallel_for(particles.size(), [&](std::size_t i) {
    float &kappa = particles.density_pressure[i], &least = particles.least_pressure[i];
    const bool presses = kappa > least;
    least = notes[i][1] > 0 ? std::min(0.0f, least + notes[i][0]) : 0;
    // A particle that does not press keeps its tension: the next density solve lowers it as far as it takes
    // to bring the liquid back to rest density, which closes the gaps between particles.
    kappa = std::max(least, presses ? kappa + notes[i][0] : std::min(kappa, 0.0f));
  });
}

}  // namespace kappaflow
