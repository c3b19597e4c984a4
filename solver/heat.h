// Heat in the liquid: conduction between its particles, from and to walls, and loss at the free surface.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// What a step did to the liquid's heat.
struct HeatSolve {
  int iterations = 0;
  double error = 0;       ///< of the change in temperature, over what is tolerated; at most 1: converged [1]
  bool sound = true;      ///< whether every temperature is above 0 K, and finite
  double from_walls = 0;  ///< heat that they gave [J]
  double from_air = 0;    ///< and that the air gave through the free surface; negative where liquid cools [J]
};

/// Area of free surface over its volume [1/m] of a particle at the relative density [1]: each face of its
/// cube that has no neighbour takes about a sixth of the density; a wall in its place closes it. Liquid
/// within is not free of gaps: up to 0.04 they do not count, from 0.12 on fully. Surfaces that are a plane of
/// a cubic lattice are 10 % smaller, those of liquid that has flowed 5 to 25 % larger than what they should
/// be.
float free_area(float density, float spacing);

/// Solves rho c dT/dt = div (k grad T) for all particles, implicitly: with u the change of T in a step,
///   (rho c V + dt K) u = -dt K T + dt b,
///   (K T)_i = V sum_j 2 k_ij |V F_ij| (T_i - T_j) + V k_i g_i T_i + V a_i h_i T_i,
///   b_i     = V k_i g_i T_w + V a_i h_i T_a + V a_w q,
/// by conjugate gradients with the diagonal as preconditioner. The first sum is the conduction of Cleary &
/// Monaghan, "Conduction modelling using smoothed particle hydrodynamics" (1999), k_ij the harmonic mean,
/// scaled so that it is exact for quadratic T on a cubic lattice; where neighbours are missing no heat flows.
/// g is the friction of the walls (WallSums), which conduct as they drag; a_w = spacing g / 2, the area of
/// wall over the volume; a: free_area(); h = convection + emissivity sigma (T^2 + T_a^2)(T + T_a) with the T
/// before the step, by which radiation is linear in the T after it.
///
/// K is symmetric with row sums that are not negative, so that no temperature leaves the range of those
/// before, the walls' and the air's, but by the walls' fluxes; and |u - u'| <= max |r| / (rho c V) for a u'
/// with the residual r, which is how it ends. What is left unsolved is not lost: heat is exchanged as the
/// pairs' temperatures u' say, and so conserved to rounding. Particles of an emitter lose nothing to the air
/// before they have passed the mouth.
class HeatSolver {
 public:
  explicit HeatSolver(const FluidOptions& options);

  bool needed() const { return options_.has_value(); }

  /// Gives the particles that have no temperature yet, which come last, that of their emitter.
  void add_new(FluidParticles& particles) const;

  /// Replaces particles.temperature. Does nothing where it is not needed. time_step [s].
  HeatSolve solve(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                  float time_step);

  std::size_t bytes() const { return bytes_of(diagonal_, right_, change_, residual_, direction_, image_); }

 private:
  template <class Visit>
  void for_pairs(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const Visit& visit) const;
  double contact_conductance(std::size_t i, std::size_t contact, const FluidParticles& particles,
                             const WallSums& walls) const;
  double wall_conductance(std::size_t i, const FluidParticles& particles, const WallSums& walls) const;
  double air_conductance(std::size_t i, const FluidParticles& particles) const;
  double from_walls(std::size_t i, const FluidParticles& particles, const WallSums& walls, double t) const;

  void set_up(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
              double time_step);
  /// Finds the change of temperature.
  HeatSolve iterate(const FluidParticles& particles, const NeighbourLists& lists, double time_step);
  /// Lets heat flow as the temperatures after the step say.
  void exchange(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                double time_step, HeatSolve& result);

  std::optional<HeatOptions> options_;
  float spacing_;
  double volume_;  // of a particle [m3]
  std::vector<double> emitter_temperature_;
  std::vector<double> capacity_;           // by fluid: rho c [J/(m3 K)]
  std::vector<double> conductivity_;       // by fluid [W/(m K)]
  std::vector<double> pair_conductivity_;  // by fluid and fluid: the harmonic mean, scaled
  // One a particle, over its volume: the matrix's diagonal and right side, and those of conjugate gradients.
  std::vector<double> diagonal_, right_, change_, residual_, direction_, image_;
};

}  // namespace kappaflow
