#include "solver/viscous_forces.h"

#include <algorithm>

namespace kappaflow {

ViscousForces::ViscousForces(const FluidOptions& options)
    : weight_(static_cast<float>(2 * options.spacing)), fluids_(options.fluids()) {
  std::vector<double> kinematic;
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid) kinematic.push_back(options.viscosity(fluid));
  const double contact = kContactDistance * options.spacing;
  for (const double viscosity : kinematic)
    wall_viscosity_.push_back(static_cast<float>(viscosity / (1 + options.slip_length / contact)));
  for (const double a : kinematic)
    for (const double b : kinematic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0);
  for (const float viscosity : pair_viscosity_) pair_scale_.push_back(weight_.scale() * viscosity);
}

bool ViscousForces::none() const {
  return std::ranges::max(pair_viscosity_) == 0;
}

}  // namespace kappaflow
