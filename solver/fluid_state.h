// What a solver holds.
#pragma once

#include <memory>
#include <utility>

#include "core/errors.h"
#include "core/time_table.h"
#include "solver/body_collisions.h"
#include "solver/boundary.h"
#include "solver/emitter.h"
#include "solver/fluid_solver.h"
#include "solver/halo.h"
#include "solver/heat.h"
#include "solver/isotropic_pressure.h"
#include "solver/neighbours.h"
#include "solver/outflow.h"
#include "solver/pressure.h"
#include "solver/rigid_bodies.h"
#include "solver/surface_tension.h"
#include "solver/viscosity.h"
#include "solver/viscous_pressure.h"

namespace kappaflow {

struct FluidSolver::State {
  State(const FluidOptions& o, Walls w, RigidBodies b, BodyCollisions c, Ranks* r)
      : options(o),
        search(static_cast<float>(o.spacing)),
        walls(std::move(w)),
        bodies(std::move(b)),
        collisions(std::move(c)),
        viscosity(o),
        pressure(o),
        viscous_pressure(o),
        tension(o),
        isotropic(o),
        heat(o),
        emitters(o),
        outflows(o),
        gravity(o.gravity_in_time()),
        ranks(r) {
    if (ranks != nullptr) halo = std::make_unique<Halo>(*ranks, o.spacing, o.heat.has_value());
  }

  void begin();
  FluidStep step(double time_left);
  void emit(double until);
  void find_neighbours();
  void sum_walls();
  void place_bodies();
  /// What takes part in pressure and viscosity, if anything.
  RigidBodies* moved_bodies() { return bodies.none() ? nullptr : &bodies; }
  Coupling coupling() { return {moved_bodies(), &wall_sums}; }
  int move_apart(double tolerance);
  void settle();
  int relieve_squeezed();
  double time_step(double time_left) const;
  void check_finite() const;
  void check_positions() const;
  void check_heat(const HeatSolve& solve) const;
  void check_viscosity(const ViscositySolve& solve) const;
  void check_pressure(const PressureSolve& solve, const char* solver, double tolerance) const;
  void check_motion(double time_step) const;
  void measure(FluidStep& done);
  SolverMemory memory() const;
  std::vector<RankShare> shares() const;
  double exchange_seconds() const { return ranks != nullptr ? ranks->traffic().seconds : 0; }
  /// Of all ranks, on the first: state and densities, or only id, position and velocity.
  const FluidParticles& all_particles(bool motion);
  const FluidParticles& particles_of(Whose whose, bool motion) {
    return whose == Whose::own ? particles : all_particles(motion);
  }
  double fast_speed(double share) const;
  void collect(bool motion);
  void restart();
  void share_restored();
  template <class Work>
  void together(const RankOrder& order, const Work& work);
  template <class Archive>
  void serialize(Archive& archive);

  FluidOptions options;
  NeighbourSearch search;
  Walls walls;
  RigidBodies bodies;
  BodyCollisions collisions;
  ViscositySolver viscosity;
  PressureSolver pressure;
  ViscousPressure viscous_pressure;
  SurfaceTension tension;
  IsotropicPressure isotropic;
  HeatSolver heat;
  Emitters emitters;
  Outflows outflows;
  TimeTable<Vec3> gravity;
  Ranks* ranks;                // that share the liquid, or nullptr
  std::unique_ptr<Halo> halo;  // likewise

  double time = 0;
  std::size_t steps = 0;
  double fastest = 0;      // speed now
  double own_seconds = 0;  // see RankShare
  FluidParticles particles;
  NeighbourLists neighbours;
  WallSums wall_sums;
  // On the first of several ranks, if they have been collected since the last step.
  enum class Collected { nothing, motion, all } collected = Collected::nothing;
  FluidParticles whole;
};

/// What all ranks do when the first one begins it, and the others follow. An error of the liquid's all of
/// them find; the first one has it. Any other leaves the ranks out of step.
template <class Work>
void FluidSolver::State::together(const RankOrder& order, const Work& work) {
  if (ranks == nullptr) return work();
  const bool first = ranks->rank() == 0;
  if (first) ranks->announce(order);
  try {
    work();
  } catch (const SolverFailure&) {
    ranks->finish();
    if (first) throw;
  } catch (const InvalidInput&) {  // of begin()
    ranks->finish();
    if (first) throw;
  }
  ranks->finish();
}

/// Largest speed [m/s]; infinite when the velocity of any particle is not finite.
double fastest_speed(const FluidParticles& particles);
/// Mean of max(rho/rho0 - 1, 0).
double mean_compression(const FluidParticles& particles);
/// Largest rho/rho0 - 1, or 0.
float largest_compression(const FluidParticles& particles);

}  // namespace kappaflow
