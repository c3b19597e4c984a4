// The SPH solver for viscous liquid. Start reading at FluidSolver::step().
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/particles.h"
#include "core/solid_wall.h"
#include "core/types.h"
#include "solver/options.h"
#include "solver/ranks.h"
#include "solver/rigid_body.h"

namespace kappaflow {

/// Wall time of the phases of a step [s].
struct SolverSeconds {
  double forces = 0;  ///< gravity, surface tension and the last step's pressure; and heat
  double viscosity = 0;
  double density = 0;     ///< the constant-density solve
  double neighbours = 0;  ///< moving, sorting and search
  double walls = 0;
  double divergence = 0;  ///< the divergence-free solve
  double step = 0;        ///< all of these and the rest
};

/// What one time step did.
struct FluidStep {
  double time_step = 0;  ///< [s]
  int density_iterations = 0;
  int divergence_iterations = 0;
  int viscosity_iterations = 0;
  int heat_iterations = 0;
  double viscosity_error = 0;     ///< see ViscositySolve: at most 1, or the solve has not converged [1]
  double density_error_mean = 0;  ///< mean of max(rho/rho0 - 1, 0) over the particles [1]
  double density_error_max = 0;   ///< maximum likewise [1]
  double heat_from_walls = 0;     ///< that the liquid gained through them [J]
  double heat_from_air = 0;       ///< and through its free surface, negative where it cools [J]
  double fastest = 0;             ///< largest particle speed [m/s]
  SolverSeconds seconds;
};

/// What the solver's arrays take [bytes].
struct SolverMemory {
  std::size_t fluid = 0;  ///< of the particles of liquid, with all that is kept for them
  std::size_t walls = 0;  ///< of the wall particles
  std::size_t wall_particles = 0;
};

/// Whose particles: of all ranks that share the liquid, known to the first one, by ascending id; or a rank's
/// own, as they lie.
enum class Whose { all, own };

/// What a solver has saved, see core/saved_state.h, as it is.
struct SavedFluid {
  double time = 0;  ///< [s]
  std::size_t steps = 0;
  std::string bytes;
};

/// A viscous liquid between rigid walls, and rigid bodies in it.
class FluidSolver {
 public:
  /// position, velocity: one entry a particle; ids are 0, 1, ... in this order, and go on in the order in
  /// which emitters make particles; those that outflows take are not used again. Walls with different motions
  /// are solids of their own: where they meet liquid they should not overlap. Particles that start compressed
  /// are moved apart. fluid: which of the fluids each particle is of; empty: all of fluid 0. source: numbers
  /// of the caller's that stay with the particles; empty: all 0. temperature: absolute, where there is heat
  /// [K]; empty: that of HeatOptions. bodies: rigid ones that liquid moves; a body may touch walls and other
  /// bodies, and should not begin in them. Throws InvalidInput for options out of range, particles inside a
  /// wall or a body, or when there is no particle at t = 0. ranks: the processes that share the liquid, each
  /// of which makes a solver of the same options, walls and bodies; the particles are the first one's.
  FluidSolver(const FluidOptions& options, std::span<const Vec3> position, std::span<const Vec3> velocity,
              std::span<const SolidWall> walls, std::span<const std::uint8_t> fluid = {},
              std::span<const int> source = {}, std::span<const double> temperature = {},
              std::span<const RigidBody> bodies = {}, Ranks* ranks = nullptr);
  ~FluidSolver();
  FluidSolver(FluidSolver&&) noexcept;
  FluidSolver& operator=(FluidSolver&&) noexcept;

  /// Advances by one adaptive time step, not longer than time_left [s].
  /// Throws SolverFailure when a number is not finite, when the step would have to be shorter than
  /// min_time_step, when a solver is far from converged at its last iteration, or when it would move a
  /// particle by ten spacings. After an exception particles() and the like say where it failed, but the
  /// solver can go no further.
  FluidStep step(double time_left);

  /// Whether ranks that share the liquid can still be asked for it, after an error: not where only one of
  /// them has met it.
  bool can_be_asked() const;

  /// Of ranks above 0, which nothing else is asked of: does with the first rank what that is asked to do,
  /// until that is of no concern to the solver. Returns what it is.
  RankOrder follow();
  /// Of each rank that shares the liquid; none without ranks.
  std::vector<RankShare> shares() const;

  double time() const;        ///< [s]
  std::size_t steps() const;  ///< since t = 0
  std::size_t size() const;   ///< particles; changes where there are emitters or outflows
  /// Particles that each outflow region has taken away since t = 0.
  std::vector<std::size_t> taken() const;
  std::vector<BodyState> bodies() const;  ///< now, in the order given
  double fast_speed(double share) const;  ///< quantile() of the particles' speeds [m/s]
  SolverMemory memory() const;
  Particles particles(Whose whose = Whose::all) const;               ///< now
  std::vector<float> densities(Whose whose = Whose::all) const;      ///< [kg/m3]
  std::vector<float> pressures(Whose whose = Whose::all) const;      ///< [Pa]
  std::vector<std::uint8_t> fluids(Whose whose = Whose::all) const;  ///< which fluid
  std::vector<int> sources(Whose whose = Whose::all) const;          ///< as given, or of the emitter
  std::vector<double> temperatures(Whose whose = Whose::all) const;  ///< [K]; empty without heat

  /// See core/saved_state.h; for a solver that was made with the same arguments.
  template <class Archive>
  void serialize(Archive& archive);
  /// What serialize() reads, for a solver elsewhere: what an archive holds of one with these arguments.
  template <class Archive>
  static SavedFluid take_saved(Archive& archive, const FluidOptions& options,
                               std::span<const RigidBody> bodies);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kappaflow
