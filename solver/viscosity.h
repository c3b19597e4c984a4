// Implicit viscosity: Weiler, Koschier, Brand & Bender, "A physically consistent implicit viscosity solver
// for SPH fluids" (2018), with rest volumes in place of the current ones, which makes the system symmetric.
#pragma once

#include <array>
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
T viscosity_weight(const T& r2, float support) {
  const float square = support * support;
  const T s = 1.0f - r2 * (1 / square);
  return (16 / (square * square)) * s * (0.56891262f + s * (5.23485966f * s - 2.36495851f));
}

/// xx, yy, zz, yz, xz, xy
using SymmetricMatrix = std::array<float, 6>;

/// How a viscosity solve ended.
struct ViscositySolve {
  int iterations = 0;
  double residual =
      0;  ///< |r| / |b| of docs/viscosity.md: what is left of the forces that were to be found [1]
};

/// Solves (I + dt L) v = v* + dt f for the new velocities v, where f - L v is the viscous acceleration
/// [m/s2],
///   (L v)_i = sum_j nu_ij c_ij x_ij (x_ij . v_ij) + nu_i' g_i (I - n n^T) v_i:
/// L is symmetric, positive semidefinite, zero for rigid motions of free liquid; f_i = nu_i' g_i (I - n n^T)
/// v_w is what moving walls drive (g, n and v_w: see WallSums; nu': pair and wall viscosities [m2/s]). The
/// particles that an emitter leads keep their velocity; the others are solved for. Conjugate gradients on the
/// change v - v*, starting from the last step's, preconditioned by the inverses of the 3x3 diagonal blocks.
/// See docs/viscosity.md.
class ViscositySolver {
 public:
  explicit ViscositySolver(const FluidOptions& options);

  /// Replaces particles.velocity, v* -> v, and viscous_change, the last v - v* -> this one. Ends when
  /// |residual| <= FluidOptions::viscosity_tolerance |dt (L v* - f)|, or after max_viscosity_iterations; says
  /// nothing where it did not get there. Does nothing where no fluid is viscous. time_step [s].
  ViscositySolve solve(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                       float time_step);

  /// (I + dt L) u for one vector a particle.
  void apply(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
             float time_step, const std::vector<Vec4f>& u, std::vector<Vec4f>& result) const;

  std::size_t bytes() const { return bytes_of(inverse_diagonal_); }

 private:
  class ConjugateGradients;

  Vec4f apply_to(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const WallSums& walls, float time_step, const std::vector<Vec4f>& u) const;
  void invert_diagonal(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                       float time_step);

  /// Kinematic viscosities between a particle of `fluid` and the eight of the block, 0 for padding [m2/s].
  Wide pair_viscosity(std::uint8_t fluid, const FluidParticles& particles, const PairBlock& block) const;

  float support_;  // of the kernel [m]
  std::size_t fluids_;
  std::vector<float> pair_viscosity_;  // kinematic, by i and j [m2/s]
  std::vector<float> wall_viscosity_;  // by i: the same times d / (d + slip length), d the contact distance
  double tolerance_;                   // on |residual| / |dt L v*|
  int max_iterations_;
  std::vector<SymmetricMatrix> inverse_diagonal_;
};

}  // namespace kappaflow
