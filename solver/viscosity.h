// Implicit viscosity: Weiler, Koschier, Brand & Bender, "A physically consistent implicit viscosity solver
// for SPH fluids" (2018), with rest volumes in place of the current ones, which makes the system symmetric.
#pragma once

#include <array>
#include <vector>

#include "solver/body_drag.h"
#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"
#include "solver/rigid_balance.h"
#include "solver/rigid_multigrid.h"
#include "solver/viscous_forces.h"

namespace kappaflow {

/// How a viscosity solve ended.
struct ViscositySolve {
  int iterations = 0;
  int systems = 0;   ///< that were set up; more than one where the viscosity depends on the shear rate
  double error = 0;  ///< estimated error of the velocities over what is tolerated [1]; at most 1: converged
};

/// Solves A v = m v* + dt f, A = m + dt L, for the new velocities v, where f - L v is the viscous force over
/// the mass of a particle of fluid 0 (see viscous_forces.h), m that of each particle over the same. The
/// particles that an emitter leads keep their velocity; the others are solved for by conjugate gradients,
/// preconditioned by RigidMultigrid, beginning where v would be if it changed as in the last step (weak
/// fluids: if viscosity did what it did then). What is left unsolved changes neither linear nor angular
/// momentum: see MomentumBalance.
///
/// They end when the root mean square error e of the velocities, weighted by the masses, is tolerated:
///   e <= FluidOptions::viscosity_tolerance * clamp(min(|v - v*|, |v|), 0.1 g dt, g dt),
/// with root mean squares of what viscosity has changed and of the liquid's own speed, or after
/// max_viscosity_iterations. e^2 is estimated from above by r . M^-1 r / sum m; A >= m, so that e . m e
/// <= e . A e = r . A^-1 r. See docs/viscosity.md.
///
/// Where a viscosity depends on the shear rate, A is that of the velocities found: it is set up and solved
/// anew from them until that begins with an error that is tolerated (Picard's iteration; docs/materials.md).
/// max_viscosity_iterations is the limit of all together.
class ViscositySolver {
 public:
  explicit ViscositySolver(const FluidOptions& options);

  /// Replaces particles.velocity, v* -> v, and viscous_velocity, the last v -> this one. Does nothing where
  /// no fluid is viscous. time_step [s]; time: at which the step begins, for the gravity of then [s]. bodies:
  /// the rigid ones that it moves, or nullptr; they are eliminated from the system (BodyDrag).
  ViscositySolve solve(FluidParticles& particles, const NeighbourLists& lists, WallSums& walls,
                       float time_step, double time = 0, RigidBodies* bodies = nullptr);

  /// A u of one vector a particle, of rigid bodies at rest.
  void apply(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
             float time_step, const std::vector<Vec4f>& u, std::vector<Vec4f>& result) const;

  std::size_t bytes() const { return preconditioner_.bytes() + balance_.bytes(); }

 private:
  class ConjugateGradients;
  struct Squares;

  void solve_system(ConjugateGradients& step, double speed_of_fall, ViscositySolve& result);
  double tolerated(const Squares& squares, double speed_of_fall) const;

  ViscousForces forces_;
  RigidMultigrid preconditioner_;
  MomentumBalance balance_;
  TimeTable<Vec3> gravity_;
  double tolerance_;  // of the velocities' error
  int max_iterations_;
};

}  // namespace kappaflow
