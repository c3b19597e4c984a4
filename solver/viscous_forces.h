// The linear map from the liquid's velocities to viscous accelerations.
#pragma once

#include <span>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// c [1/m4] of a pair of liquid particles, so that the viscous acceleration is -nu sum_j c_ij x_ij (x_ij .
/// v_ij). Any c(r) >= 0 whose fourth moment sum_j c x x x x is that of the Laplacian will do (Espanol &
/// Revenga, "Smoothed dissipative particle dynamics", 2003); the usual 2 (d + 2) V |F| / (r2 + 0.01
/// support^2) of Weiler et al. 2018, Eq. 8, makes a cubic lattice, with which liquid starts and which slow
/// flow keeps, 0.70 times as viscous as it should be in shear along its axes and 1.23 times at 45 degrees.
/// The three coefficients here make the fourth moment isotropic and right on the lattice of the spacing, and
/// right for a continuum of particles. T is float or Wide.
template <class T>
[[gnu::always_inline]] inline T viscosity_weight(const T& r2, float support) {
  const float square = support * support;
  const T s = 1.0f - r2 * (1 / square);
  return (16 / (square * square)) * s * (0.56891262f + s * (5.23485966f * s - 2.36495851f));
}

/// xx, yy, zz, yz, xz, xy
using SymmetricMatrix = std::array<float, 6>;

/// The viscous acceleration is f - L v [m/s2]:
///   (L v)_i = sum_j nu_ij c_ij x_ij (x_ij . v_ij) + nu_i' g_i (I - n n^T) v_i,
///   f_i     = nu_i' g_i (I - n n^T) v_w,
/// with nu_ij the viscosity between two particles, nu' that at walls [m2/s] (g, n and v_w: see WallSums). L
/// is symmetric, positive semidefinite, and zero for rigid motions of free liquid.
class ViscousForces {
 public:
  explicit ViscousForces(const FluidOptions& options);

  /// Whether no fluid is viscous.
  bool none() const;
  float largest_viscosity() const;  ///< [m2/s]
  /// Whether the particle feels viscous forces.
  bool act_on(std::size_t i, const FluidParticles& particles) const {
    return wall_viscosity_[particles.fluid[i]] > 0 || pair_viscosity_[particles.fluid[i] * (fluids_ + 1)] > 0;
  }

  /// Calls visit(block, x, w) for the blocks of particle i's neighbours: x = x_ij [m], w = nu_ij c_ij
  /// [1/(m2 s)], 0 for padding.
  template <class Visit>
  void for_pairs(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const Visit& visit) const;

  /// (L v)_i for one vector a particle.
  Vec4f resistance(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                   const WallSums& walls, const std::vector<Vec4f>& v) const;
  /// nu_i' g_i (I - n n^T) u, the walls' part of it.
  Vec4f wall_drag(std::size_t i, const FluidParticles& particles, const WallSums& walls,
                  const Vec4f& u) const {
    if (!walls.touches(i)) return Vec4f::Zero();
    return wall_viscosity_[particles.fluid[i]] * walls.drag(i, u);
  }
  /// f_i.
  Vec4f wall_drive(std::size_t i, const FluidParticles& particles, const WallSums& walls) const {
    if (!walls.touches(i)) return Vec4f::Zero();
    return wall_viscosity_[particles.fluid[i]] * walls.drive(i);
  }

 private:
  /// nu_ij of a particle of `fluid` and the eight of the block [m2/s].
  Wide viscosities(std::uint8_t fluid, const FluidParticles& particles, const PairBlock& block) const;

  float support_;  // of the kernel [m]
  std::size_t fluids_;
  std::vector<float> pair_viscosity_;  // kinematic, by i and j: the harmonic mean [m2/s]
  std::vector<float> wall_viscosity_;  // by i: the same times d / (d + slip length), d the contact distance
};

template <class Visit>
inline void ViscousForces::for_pairs(std::size_t i, const FluidParticles& particles,
                                     const NeighbourLists& lists, const Visit& visit) const {
  const Vec4f xi = particles.position[i];
  Wide viscosity = Wide::Constant(pair_viscosity_.front());
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide r2 = x * x + y * y + z * z;
    if (fluids_ > 1) viscosity = viscosities(particles.fluid[i], particles, block);
    const Wide weight = viscosity * block.present() * viscosity_weight<Wide>(r2, support_);
    visit(block, WideVec{x, y, z, r2}, weight);
  }
}

}  // namespace kappaflow
