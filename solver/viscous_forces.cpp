#include "solver/viscous_forces.h"

#include <algorithm>

namespace kappaflow {

ViscousForces::ViscousForces(const FluidOptions& options)
    : support_(static_cast<float>(2 * options.spacing)), fluids_(options.fluids()) {
  std::vector<double> kinematic;
  for (std::size_t fluid = 0; fluid < fluids_; ++fluid) kinematic.push_back(options.viscosity(fluid));
  const double contact = kContactDistance * options.spacing;
  for (const double viscosity : kinematic)
    wall_viscosity_.push_back(static_cast<float>(viscosity / (1 + options.slip_length / contact)));
  for (const double a : kinematic)
    for (const double b : kinematic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0);
}

bool ViscousForces::none() const {
  return largest_viscosity() == 0;
}

float ViscousForces::largest_viscosity() const {
  return std::ranges::max(pair_viscosity_);
}

Wide ViscousForces::viscosities(std::uint8_t fluid, const FluidParticles& particles,
                                const PairBlock& block) const {
  const float* with = pair_viscosity_.data() + fluid * fluids_;
  Wide result;
  for (int k = 0; k < kWide; ++k)
    result[k] = with[particles.fluid[block.base + block.offset[static_cast<std::size_t>(k)]]];
  return result;
}

Vec4f ViscousForces::resistance(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                const WallSums& walls, const std::vector<Vec4f>& v) const {
  const Vec4f& vi = v[i];
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for_pairs(i, particles, lists, [&](const PairBlock& block, const WideVec& x, const Wide& weight) {
    const WideVec vj = gather(v, block);
    const Wide scale = weight * (x.x * (vi[0] - vj.x) + x.y * (vi[1] - vj.y) + x.z * (vi[2] - vj.z));
    sum_x += scale * x.x;
    sum_y += scale * x.y;
    sum_z += scale * x.z;
  });
  return Vec4f(sum_x.sum(), sum_y.sum(), sum_z.sum(), 0) + wall_drag(i, particles, walls, vi);
}

}  // namespace kappaflow
