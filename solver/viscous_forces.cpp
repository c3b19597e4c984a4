#include "solver/viscous_forces.h"

#include <algorithm>

#include "core/parallel.h"
#include "solver/shear_rate.h"

namespace kappaflow {

namespace {

/// How far from a wall with the friction g (WallSums) a particle is: g = 1 / (spacing d). At most one
/// spacing, for g vanishes there.
float wall_distance(float friction, float spacing) {
  return 1 / (spacing * std::max(friction, 1 / (spacing * spacing)));
}

}  // namespace

ViscousForces::ViscousForces(const FluidOptions& options)
    : weight_(static_cast<float>(2 * options.spacing)),
      spacing_(static_cast<float>(options.spacing)),
      slip_(static_cast<float>(1 / (1 + options.slip_length / (kContactDistance * options.spacing)))),
      fluids_(options.fluids()) {
  std::vector<double> kinematic;
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid) kinematic.push_back(options.viscosity(fluid));
  const double contact = kContactDistance * options.spacing;
  for (const double viscosity : kinematic)
    wall_viscosity_.push_back(static_cast<float>(viscosity / (1 + options.slip_length / contact)));
  for (const double a : kinematic)
    for (const double b : kinematic)
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
                                     const WallSums& walls, const std::vector<Vec4f>& v) {
  const std::size_t n = particles.size();
  particles.viscosity.resize(n);
  particles.wall_viscosity.resize(n);
  parallel_for(n, [&](std::size_t i) { find_viscosity(i, particles, lists, walls, v); });
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid)
    if (laws_[fluid].varies())
      viscosity_[fluid] = parallel_max(
          n, 0.0f, [&](std::size_t i) { return particles.fluid[i] == fluid ? particles.viscosity[i] : 0; });
}

void ViscousForces::find_viscosity(std::size_t i, FluidParticles& particles, const NeighbourLists& lists,
                                   const WallSums& walls, const std::vector<Vec4f>& v) const {
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
    return static_cast<float>(shift * viscosity_at(law.of_shear, shift * static_cast<double>(rate)));
  };
  own = at_rate(shear_rate(i, particles, lists, walls, v, spacing_, slip_));
  at_wall = wall_viscosity_[fluid];
  if (!walls.touches(i)) return;
  Vec4f u = v[i];
  if (!walls.velocity.empty()) u -= without_fourth(walls.velocity[walls.contact[i]]);
  const Vec4f friction = walls.friction[walls.contact[i]], n = without_fourth(friction);
  const float along = (u - n.dot(u) * n).norm();
  at_wall = slip_ * at_rate(slip_ * along / wall_distance(friction[3], spacing_));
}

bool ViscousForces::none() const {
  return !vary() && std::ranges::max(pair_viscosity_) == 0;
}

}  // namespace kappaflow
