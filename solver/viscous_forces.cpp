#include "solver/viscous_forces.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/shear_rate.h"

namespace kappaflow {

namespace {

/// How far from a wall with the friction g (WallSums) a particle is: g = 1 / (spacing d). At most one
/// spacing, for g vanishes there.
float wall_distance(float friction, float spacing) {
  return 1 / (spacing * std::max(friction, 1 / (spacing * spacing)));
}

/// How much of the way, in its logarithm, a viscosity goes from one iterate to the next. The iteration turns
/// a small relative error of the shear rate into 1 - n times it; of liquid that thickens, so much of the way
/// leaves none.
float share_of_step(const Rheology& law) {
  const auto* const power = std::get_if<HerschelBulkley>(&law);
  return power != nullptr && power->index > 1 ? static_cast<float>(1 / power->index) : 1;
}

}  // namespace

ViscousForces::ViscousForces(const FluidOptions& options)
    : weight_(static_cast<float>(2 * options.spacing)),
      spacing_(static_cast<float>(options.spacing)),
      slip_(static_cast<float>(1 / (1 + options.slip_length / (kContactDistance * options.spacing)))),
      fluids_(options.fluids()) {
  std::vector<double> dynamic;
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid) {
    mass_.push_back(static_cast<float>(options.relative_mass(fluid)));
    dynamic.push_back(options.relative_mass(fluid) * options.viscosity(fluid));
  }
  const double contact = kContactDistance * options.spacing;
  for (const double viscosity : dynamic)
    wall_viscosity_.push_back(static_cast<float>(viscosity / (1 + options.slip_length / contact)));
  for (const double a : dynamic)
    for (const double b : dynamic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0);
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid)
    reference_viscosity_.push_back(pair_viscosity_[fluid * (fluids_ + 1)]);
  viscosity_ = reference_viscosity_;
  for (const float viscosity : pair_viscosity_) pair_scale_.push_back(weight_.scale() * viscosity);
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid)
    laws_.push_back({options.rheology(fluid), options.temperature_law(fluid)});
  depend_on_flow_ = !std::ranges::all_of(laws_, is_newtonian, &Law::of_shear);
  if (std::ranges::none_of(laws_, &Law::varies)) laws_.clear();
}

void ViscousForces::find_viscosities(FluidParticles& particles, const NeighbourLists& lists,
                                     const WallSums& walls, std::vector<Vec4f>& v, bool again) {
  const std::size_t n = particles.size();
  particles.viscosity.resize(n);
  particles.wall_viscosity.resize(n);
  fill_ghosts(particles, v);
  parallel_for(n, [&](std::size_t i) { find_viscosity(i, particles, lists, walls, v, again); });
  fill_ghosts(particles, particles.viscosity);
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid) {
    if (!laws_[fluid].varies()) continue;
    const float most = parallel_max(
        n, 0.0f, [&](std::size_t i) { return particles.fluid[i] == fluid ? particles.viscosity[i] : 0; });
    viscosity_[fluid] = max_of_ranks(particles, most);
  }
}

void ViscousForces::find_viscosity(std::size_t i, FluidParticles& particles, const NeighbourLists& lists,
                                   const WallSums& walls, const std::vector<Vec4f>& v, bool again) const {
  const std::uint8_t fluid = particles.fluid[i];
  const Law& law = laws_[fluid];
  const double shift = has_temperature_law(law.of_temperature)
                           ? shift_factor(law.of_temperature, particles.temperature[i])
                           : 1;
  float &own = particles.viscosity[i], &at_wall = particles.wall_viscosity[i];
  if (is_newtonian(law.of_shear)) {
    own = static_cast<float>(shift) * reference_viscosity_[fluid];
    at_wall = static_cast<float>(shift) * wall_viscosity_[fluid];
    return;
  }
  const auto at_rate = [&](float rate) {
    return mass_[fluid] *
           static_cast<float>(shift * viscosity_at(law.of_shear, shift * static_cast<double>(rate)));
  };
  const float share = again ? share_of_step(law.of_shear) : 1;
  const auto approach = [&](float& viscosity, float found) {
    viscosity = share < 1 ? std::pow(found, share) * std::pow(viscosity, 1 - share) : found;
  };
  approach(own, at_rate(shear_rate(i, particles, lists, walls, v, spacing_, slip_)));
  if (!walls.touches(i)) return;
  float largest = 0;
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k) {
    Vec4f u = v[i];
    if (!walls.velocity.empty()) u -= without_fourth(walls.velocity[k]);
    const Vec4f friction = walls.friction[k], n = without_fourth(friction);
    const float along = (u - n.dot(u) * n).norm();
    largest = std::max(largest, slip_ * along / wall_distance(friction[3], spacing_));
  }
  approach(at_wall, slip_ * at_rate(largest));
}

bool ViscousForces::none() const {
  return !vary() && std::ranges::max(pair_viscosity_) == 0;
}

}  // namespace kappaflow
