// Pressure: Bender & Koschier, "Divergence-free SPH for incompressible and viscous fluids" (2017), both of
// its solves as one bound-constrained problem.
#pragma once

#include <span>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"
#include "solver/rigid_bodies.h"

namespace kappaflow {

/// The rigid bodies that pressure pushes, with their contacts; or none.
struct Coupling {
  RigidBodies* bodies = nullptr;
  WallSums* walls = nullptr;

  void drive(const FluidParticles& particles) const {
    if (bodies != nullptr) bodies->drive(particles, *walls);
  }
  void find_push(const FluidParticles& particles) const {
    if (bodies != nullptr) bodies->find_push(particles, *walls);
  }
  void apply_push(float time) const {
    if (bodies != nullptr) bodies->apply_push(static_cast<double>(time));
  }
  void scale_push(float factor) const {
    if (bodies != nullptr) bodies->scale_push(static_cast<double>(factor));
  }
  double push_square() const { return bodies != nullptr ? bodies->push_square() : 0; }
  float push_rate(std::size_t i, const FluidParticles& particles) const {
    return bodies != nullptr ? bodies->push_rate(i, particles, *walls) : 0;
  }
  float push_diagonal(std::size_t i) const {
    return bodies != nullptr ? bodies->push_diagonal(i, *walls) : 0;
  }
};

/// How a pressure solve ended.
struct PressureSolve {
  int iterations = 0;
  /// Mean over the particles of |max(c, -d kappa)|, c the left-hand side of the constraint (predicted density
  /// over rest density less 1, or its like for the divergence) and d kappa what the particle's own pressure
  /// takes from it: how far either is from 0 where kappa >= 0 >= c must hold with one of them 0. [1]
  double mean_error = 0;
  float max_error = 0;  ///< the largest c, or 0 [1]
};

/// Finds kappa_i >= 0 [m2/s2] such that the accelerations
///   m_i a_i = -sum_j V (kappa_i + kappa_j) grad W_ij - kappa_i sum_b V_b grad W_ib
/// leave no particle compressed after the step dt, m_i the mass over that of a particle of fluid 0. With rho0
/// the rest density of fluid 0 and d the density over the particle's own rest density, kappa is p / (rho0
/// d^2): the pressure in Pa is rho0 d^2 (kappa of the density solve + kappa of the divergence solve), for
/// both act during the same dt. Density counts volume, not mass: where a light liquid meets a heavy one the
/// pressure is as smooth as elsewhere (Solenthaler & Pajarola, "Density contrast SPH interfaces", 2008).
///
/// With D the linear map from velocities to rates of relative density and M the masses, a = -M^-1 D^T kappa,
/// so kappa solves the linear complementarity problem of dt^2 D M^-1 D^T, symmetric and positive
/// semidefinite: kappa >= 0, no particle compressed, and none held below rest density by a pressure. Solved
/// by projected Jacobi steps with Nesterov's acceleration, restarted when they overshoot (O'Donoghue &
/// Candes, "Adaptive restart for accelerated gradient schemes", 2015); their length follows from the
/// curvature met on the way. Before the first and after the last the pressure as a whole is multiplied by
/// what fits it best: the slowest error, too much or too little everywhere, is gone at once (not where
/// tension is allowed, which has a bound of its own). Where there are rigid bodies, D and a have theirs too
/// (RigidBodies). The stopping error counts pressures that are too high as well as too low: the former, left
/// over from the step before, would lift the liquid. Pair forces are antisymmetric: momentum is conserved to
/// rounding.
class PressureSolver {
 public:
  explicit PressureSolver(const FluidOptions& options)
      : density_tolerance_(options.density_tolerance),
        divergence_tolerance_(options.divergence_tolerance),
        max_iterations_(options.max_pressure_iterations) {}

  /// Adds dt a of the last step's pressure to the velocities, before viscosity acts: else a viscous liquid at
  /// rest would see gravity without its support and never come to rest (Goda, "A multistep technique with
  /// implicit difference schemes for calculating two- or three-dimensional cavity flows", 1979).
  /// correct_density() replaces it.
  void apply_last(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                  const Coupling& bodies = {});

  /// Constant-density solve: rho/rho0 - 1 + dt D(v + dt a) <= 0, where v are the velocities without the
  /// pressure that apply_last() added. Replaces particles.velocity and density_pressure, which starts the
  /// iteration. time_step [s]. least: FluidParticles::least_pressure, which takes the place of the 0 that
  /// bounds kappa, or empty; if there are any, it leaves compression_rates().
  PressureSolve correct_density(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                                float time_step, std::span<const float> least = {},
                                const Coupling& bodies = {});

  /// Divergence-free solve: dt D(v + dt a) <= max(0, 1 - rho/rho0), so loose particles at a surface may come
  /// together until they are liquid. Likewise with divergence_pressure.
  PressureSolve correct_divergence(FluidParticles& particles, const NeighbourLists& lists,
                                   const WallSums& walls, float time_step, const Coupling& bodies = {});

  /// Moves particles by the least, weighted by their masses, that leaves none compressed, to first order: by
  /// a with dt = 1, for rho/rho0 - 1 + D a <= 0. Velocities and pressures stay. Ends when at most `tolerance`
  /// of compression is left in the mean and 1 percent at any particle. Rigid bodies stand still.
  PressureSolve move_apart(FluidParticles& particles, const NeighbourLists& lists, double tolerance);

 private:
  struct Progress;

  PressureSolve solve(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                      double tolerance, int min_iterations, std::span<const float> least,
                      const Coupling& bodies);
  Progress iterate(FluidParticles& particles, const NeighbourLists& lists, float square_step,
                   float relaxation, std::span<const float> least, const Coupling& bodies, bool first);

  double density_tolerance_, divergence_tolerance_;
  int max_iterations_;
};

/// D u: rate of change of the relative density that velocities u cause between walls at rest [1/s],
/// sum_j V (u_i - u_j) . grad W_ij + u_i . sum_b V_b grad W_ib.
float density_rate(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                   const std::vector<Vec4f>& u);

/// What PressureSolver::correct_density() leaves: D v of the velocities that it was given, in the first
/// component [1/s].
inline std::vector<Vec4f>& compression_rates(FluidParticles& particles) {
  return particles.scratch[2];
}

/// -M^-1 D^T kappa: the accelerations a_i above [m/s2], with kappa_i in position[i].w. Zero for a particle
/// that an emitter leads, as if its mass were infinite; the system stays symmetric.
Vec4f pressure_acceleration(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists);

}  // namespace kappaflow
