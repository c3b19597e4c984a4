// What pressure and viscosity have to do with each other in thick liquid: pressure is found for the flow that
// viscosity leaves, and where liquid is stretched it is below the air's.
#pragma once

#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// Whether the momentum of liquid of this kinematic viscosity [m2/s] crosses six spacings in the longest
/// step.
bool is_thick(double viscosity, const FluidOptions& options);

/// The pressure solve makes the flow incompressible as if there were no viscosity, and the viscous solve of
/// the next step takes most of that back: in thick liquid the two agree only after many steps, and until then
/// it yields where it should buckle. So the pressure that the viscous solve starts from is corrected by what
/// that solve has left of compression (the rotational form of Guermond & Shen, "On the error estimates for
/// the rotational pressure-correction projection methods", 2004; Cahouet & Chabard, 1988):
///   kappa <- kappa + kBulk nu D v,
/// with D v the rate of compression after the viscous solve and nu the dynamic viscosity over the rest
/// density of fluid 0, as kappa is the pressure. kBulk nu is the resistance of this viscosity, whose pair
/// forces have a second coefficient of viscosity as large as the first, to a change of volume.
///
/// The same rule lets kappa fall below 0 where liquid is pulled: without tension a thread would keep its
/// radius as it is stretched, until its particles lose each other (Trouton, 1906: kappa = -nu times the rate
/// of stretching). FluidParticles::least_pressure is how low; the density solve keeps to it. It is 0, as in
/// thin liquid, at walls, in emitters, and for particles that are loose (with few neighbours) or beside one
/// that is, which they would draw in within a step. Pulled particles that come close to each other across the
/// thread part (spread()), so that they find room along it.
///
/// Only for fluids that are thick.
class ViscousPressure {
 public:
  ViscousPressure(const FluidOptions& options);

  /// Whether any fluid is thick; if none is, the functions below need not be called.
  bool needed() const { return needed_; }

  /// Adds time_step [s] times the accelerations -kSpread / m_i sum_j V (t_i + t_j) (W_ij / W(spacing))^4 grad
  /// W_ij, with t the negative of the least kappa; see crowding().
  void spread(FluidParticles& particles, const NeighbourLists& lists, float time_step) const;

  /// Notes kBulk nu D v, and which particles may pull. Precondition: compression_rates() are those of the
  /// velocities that the viscous solve has left.
  void measure(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls) const;

  /// density_pressure and least_pressure of the density solve -> those of the next step.
  void correct(FluidParticles& particles) const;

 private:
  void forget_beside_ghosts(FluidParticles& particles, const NeighbourLists& lists) const;
  /// kBulk nu of a particle, 0: thin [m2/s].
  float resistance(std::size_t i, const FluidParticles& particles) const;

  float spacing_;
  bool needed_ = false;
  std::vector<float> resistance_;  // by fluid: kBulk nu, of liquid that is not Newtonian at rest
  std::vector<float> least_;       // by fluid: what is less is that of thin liquid
};

}  // namespace kappaflow
