#include "solver/boundary.h"

#include <cmath>

#include "core/parallel.h"
#include "solver/viscosity.h"

namespace kappaflow {
namespace {

// Wall particles are this much larger than the liquid's, and stand so much deeper (sample_walls()) that
// liquid at half a spacing from the wall continues a lattice of rest density rho there: with S(y) the sum
// over a plane of particles at the distance y, ratio S(1.44 spacing) = S(spacing). Pressure acts through
// kappa_i + kappa_j between layers of liquid but through kappa_i alone at a wall, so the lattice is in
// balance when the wall's density rises twice as steeply: ratio S'(1.44 spacing) = 2 S'(spacing). Both hold
// for this ratio and that depth. With volumes of the liquid's size the contact layer would be squeezed until
// they do, and its pressure be wrong by as much.
constexpr float kVolumeRatio = 8;

/// Sum of the kernel over a square lattice in a plane through one of its points. A wall of such particles
/// with volumes spacing^3 continues a cubic lattice of liquid without a jump in density.
float square_lattice_sum(const CubicSpline& kernel, float spacing) {
  return kernel.value(0) + 4 * kernel.value(spacing) + 4 * kernel.value(spacing * std::sqrt(2.0f));
}

}  // namespace

Walls::Walls(std::span<const Vec3> position, float spacing)
    : kernel_(2 * spacing), samples_(position.size()) {
  const float support = kernel_.support();
  grid_.build(position, support);
  for (std::size_t b = 0; b < samples_.size(); ++b)
    samples_[b] << position[grid_.order()[b]].cast<float>(), 0.0f;
  const float full = kVolumeRatio * square_lattice_sum(kernel_, spacing) * spacing * spacing * spacing;
  std::vector<float> volume(samples_.size());
  parallel_for(samples_.size(), [&](std::size_t b) {
    float sum = 0;  // Akinci et al. 2012, Eq. 4, scaled so that an even layer gets the liquid's volumes
    grid_.ranges_near(samples_[b], support, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k)
        sum += kernel_.value((samples_[b] - samples_[k]).head<3>().norm());
    });
    volume[b] = full / sum;
  });
  for (std::size_t b = 0; b < samples_.size(); ++b) samples_[b][3] = volume[b];
}

void Walls::add_to(std::size_t i, FluidParticles& particles, WallSums& sums) const {
  const Vec4f x = particles.position[i];
  const float support = kernel_.support();
  Vec4f gradient = Vec4f::Zero();
  Mat43f friction = Mat43f::Zero();
  float density = 0;
  bool touches = false;
  grid_.ranges_near(x, support, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t b = begin; b < end; ++b) {
      Vec4f d = x - samples_[b];
      d[3] = 0;
      const float r2 = d.squaredNorm();
      if (r2 >= support * support) continue;
      const float r = std::sqrt(r2), volume = samples_[b][3], factor = volume * kernel_.gradient_factor(r);
      touches = true;
      density += volume * kernel_.value(r);
      gradient += factor * d;
      friction += viscosity_weight(r2, factor, support) * d * d.head<3>().transpose();
    }
  });
  sums.touches[i] = touches;
  sums.friction[i] = friction;
  particles.density[i] += density;
  particles.gradient_sum[i] += gradient;
}

void Walls::add_to(FluidParticles& particles, WallSums& sums) const {
  const std::size_t n = particles.size();
  sums.friction.resize(n);
  sums.touches.resize(n);
  parallel_for(n, [&](std::size_t i) { add_to(i, particles, sums); });
}

}  // namespace kappaflow
