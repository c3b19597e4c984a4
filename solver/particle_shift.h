// Order of the particles: shifts that keep sheared liquid from resisting like a solid.
#pragma once

#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// Where liquid is sheared, its particles come closer in one direction than in another, and the pressure on
/// them is then no longer the same in all directions: a stress of some percent of the pressure that resists
/// the shear, at any resolution. In thin liquid they find new places at once; in thick liquid viscosity holds
/// each beside its neighbours, and a drop that buoyancy moves slowly comes to a halt. So they are moved apart
/// as fast as shear brings them together, without velocities:
///   dx_i = kShift e_i spacing^2 sum_j V c(r_ij) |F_ij| x_ij,
/// with e the shear rate (shear_rate()) times the time step, at most kLargestStrain, and 0 near a free
/// surface, where a particle touches a wall or is led, and in fluids that are thin at rest (or at their
/// reference temperature); V F as in NeighbourLists, c: crowding(). Nothing moves by more than kLargestShift
/// e_i spacing. Shifts against disorder are usual since Xu, Stansby & Laurence, "Accuracy and stability in
/// incompressible SPH (ISPH) based on the projection method and a new approach" (2009); their size by the
/// flow is that of Oger et al., "SPH accuracy improvement through the combination of a quasi-Lagrangian
/// shifting transport velocity and consistent ALE formalisms" (2016).
///
/// Only in scenes with liquids of different density, there in all thick liquid: what moves one against the
/// other is often a small part of the pressure. Velocities stay, and with them linear momentum; the centre of
/// mass, angular momentum and the energy of weight do not quite.
class ParticleShift {
 public:
  explicit ParticleShift(const FluidOptions& options);

  bool needed() const { return needed_; }

  /// Moves the particles. Precondition: the lists and walls are those of their positions. time_step [s].
  void apply(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
             float time_step) const;

 private:
  float strain(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
               const WallSums& walls, float time_step) const;

  float spacing_;
  bool needed_;
  std::vector<char> is_thin_;  // by fluid
};

}  // namespace kappaflow
