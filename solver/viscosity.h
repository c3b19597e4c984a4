// Implicit viscosity: Weiler, Koschier, Brand & Bender, "A physically consistent implicit viscosity solver
// for SPH fluids" (2018), with rest volumes in place of the current ones, which makes the system symmetric.
#pragma once

#include <algorithm>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/fluid_solver.h"
#include "solver/neighbours.h"

namespace kappaflow {

/// c = 2 (d + 2) V |F| / (r2 + 0.01 support^2) [1/m4] of a pair in d = 3 dimensions, so that the viscous
/// acceleration is -nu sum_j c_ij x_ij (x_ij . v_ij) (Weiler et al. 2018, Eq. 8). factor: V F with grad W = F
/// x, negative.
inline float viscosity_weight(float r2, float factor, float support) {
  return -10 * factor / (r2 + 0.01f * support * support);
}

/// The coefficient e with e g g^T = c x x^T for the stored g = factor x, which saves the loops from storing x
/// too. At the edge of the support, where both sides vanish, it is kept finite.
inline float viscosity_coefficient(float r2, float factor, float support) {
  const float least = 1e-6f / (support * support);
  return 10 / ((r2 + 0.01f * support * support) * std::max(-factor, least));
}

/// Solves (I + dt L) v = v* for the new velocities v, where L v is minus the viscous acceleration: symmetric,
/// positive semidefinite, zero for rigid motions of free liquid. The particles that an emitter leads keep
/// their velocity; the others are solved for. Conjugate gradients on the change v - v*, starting from the
/// last step's, preconditioned by the inverses of the 3x3 diagonal blocks.
class ViscositySolver {
 public:
  explicit ViscositySolver(const FluidOptions& options);

  /// Replaces particles.velocity and viscous_change; returns the number of iterations. time_step [s].
  int solve(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls, float time_step);

  /// (I + dt L) u for one vector a particle.
  void apply(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
             float time_step, const std::vector<Vec4f>& u, std::vector<Vec4f>& result) const;

 private:
  Vec4f apply_to(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const WallSums& walls, float time_step, const std::vector<Vec4f>& u) const;
  void invert_diagonal(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                       float time_step);
  /// Kinematic viscosities between fluid i and fluid j, at j.
  const float* pair_viscosity(std::uint8_t i) const { return pair_viscosity_.data() + i * fluids_; }

  std::size_t fluids_;
  std::vector<float> pair_viscosity_, boundary_viscosity_;  // kinematic [m2/s]; by i and j, and by i
  double tolerance_;                                        // on |residual| / |dt L v*|
  int max_iterations_;
  std::vector<Mat43f> inverse_diagonal_;
  std::vector<Vec4f> residual_, direction_, image_, preconditioned_;
};

}  // namespace kappaflow
