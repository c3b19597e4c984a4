// Pressure that is the same in all directions where liquid has been sheared.
#pragma once

#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// Where liquid is sheared, its particles come closer in one direction than in another. The forces of
/// pressure.h are then no longer those of an isotropic pressure but of the stress -kappa_i M_i,
///   M_i = -sum_j V F_ij x_ij (x) x_ij,   V grad W_ij = V F_ij x_ij,
/// which resists the shear like a solid, by some percent of the pressure, at any resolution. In thin liquid
/// particles find new places at once; in thick liquid viscosity holds each beside its neighbours, and what
/// moves slowly under high pressure comes to a halt. So pressure acts by gradients that are right to first
/// order, L_i grad W_ij with L_i = m M_i^-1 (Bonet & Lok, "Variational and momentum preservation aspects of
/// smooth particle hydrodynamics formulations", 1999); m = tr M_i / 3 leaves what it does to the density. The
/// difference is
///   m_i a_i = sum_j (S_i + S_j) V F_ij x_ij,   S_i = k_i (I - L_i),
/// k the last step's kappa, of both solves, a mean over each particle's neighbours: what differs from one
/// particle to the next is no pressure that strain could work against, and would feed itself. It acts before
/// viscosity does. Pair forces are antisymmetric and S_i and M_i have the same axes, so linear and angular
/// momentum are conserved to rounding. S_i is 0 near a free surface, where a particle touches a wall, and in
/// liquid that is thin at rest (or at its reference temperature).
class IsotropicPressure {
 public:
  explicit IsotropicPressure(const FluidOptions& options);

  bool needed() const { return needed_; }

  /// Adds dt a to the velocities. Precondition: the lists, walls and densities are those of the positions.
  /// time_step [s].
  void apply(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
             float time_step) const;

 private:
  float share(std::size_t i, const FluidParticles& particles, const WallSums& walls) const;

  float spacing_;
  bool needed_;
  std::vector<char> is_thin_;  // by fluid
};

}  // namespace kappaflow
