// Surface tension as a central pair force: the cohesion of Akinci, Akinci & Teschner, "Versatile surface
// tension and adhesion for SPH fluids" (2013), with its strength from the theory of liquids.
#pragma once

#include "solver/fluid_particles.h"
#include "solver/fluid_solver.h"
#include "solver/neighbours.h"

namespace kappaflow {

/// Pulls neighbours together with the force m a C(r) along their connection, C of Akinci et al. 2013, Eq. 2:
/// with q = r / support, q^3 (1-q)^3 for q > 1/2 and 2 q^3 (1-q)^3 - 1/64 below, where close particles repel.
///
/// A liquid of n particles per volume whose pairs attract with F(r) has the surface tension pi/8 n^2 int r^4
/// F(r) dr, if it is uniform up to its surface (Fowler, "A tentative statistical theory of Macleod's equation
/// for surface tension", 1937); that gives a, up to kStructure for the order that the particles have.
///
/// Akinci et al. add a force along the difference of two particles' normals, which is not central. It is left
/// out: without it the pair forces have a potential, whose excess at a surface is what makes area cost
/// energy, and linear and angular momentum are both conserved to rounding. There is no force between liquid
/// and walls, so liquid does not wet them.
class SurfaceTension {
 public:
  explicit SurfaceTension(const FluidOptions& options);

  /// Adds time_step [s] times the acceleration to the velocities; does nothing where there is no tension.
  void apply(FluidParticles& particles, const NeighbourLists& lists, float time_step) const;

 private:
  float support_;
  float strength_;  // a [m/s2]
};

/// The longest step in which the shortest capillary wave, two spacings long, is resolved (Brackbill, Kothe &
/// Zemach, "A continuum method for modeling surface tension", 1992): sqrt(rho spacing^3 / (4 pi tension)).
/// Infinite without tension. [s]
double capillary_time_step(double tension, double density, double spacing);

}  // namespace kappaflow
