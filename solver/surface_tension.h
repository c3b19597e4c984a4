// Surface tension: an area that costs energy, and a cohesion that keeps the surface together; both as Akinci,
// Akinci & Teschner, "Versatile surface tension and adhesion for SPH fluids" (2013) have them, but from
// potentials.
#pragma once

#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// The accelerations of the potential energy kArea sigma A + kCohesion E per mass, where
/// - A = sum_i V (sqrt(|n_i|^2 + eps^2) - eps) is the area of the surface that the particles smooth, with n_i
///   = sum_j V grad W_ij; a particle feels -sum_j V grad grad W_ij (m_i - m_j) with m = n / sqrt(n^2 +
///   eps^2). Akinci et al. use n_i - n_j itself, which has no potential.
/// - E has the pair forces C(r) along x_ij of Akinci et al. 2013, Eq. 2: with q = r / support, q^3 (1-q)^3
/// for
///   q > 1/2 and 2 q^3 (1-q)^3 - 1/64 below, where close particles repel. Their strength is the one with
///   which a uniform liquid of such pairs has the tension sigma (Fowler, "A tentative statistical theory of
///   Macleod's equation for surface tension", 1937): sigma = pi/8 n^2 int r^4 F(r) dr.
/// The area alone lets single layers of particles fly off, for they have no n; the cohesion alone presses a
/// liquid of so few neighbours into a crystal that does not flow. An energy that does not change when the
/// liquid moves as a rigid body gives forces that conserve linear and angular momentum to rounding.
///
/// Walls count in n, so that liquid has no surface towards them; they neither attract nor repel.
class SurfaceTension {
 public:
  explicit SurfaceTension(const FluidOptions& options);

  /// Adds time_step [s] times the acceleration to the velocities; does nothing where there is no tension.
  void apply(FluidParticles& particles, const NeighbourLists& lists, float time_step) const;

 private:
  /// Precondition: m of every particle in scratch[0].
  Vec4f acceleration(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists) const;

  float inverse_support_;                    // [1/m]
  float least_gradient_;                     // eps [1/m]
  float area_strength_, cohesion_strength_;  // [m/s2]; 0: no tension
};

/// The longest step in which the shortest capillary wave, two spacings long, is resolved (Brackbill, Kothe &
/// Zemach, "A continuum method for modeling surface tension", 1992): sqrt(rho spacing^3 / (4 pi tension)).
/// Infinite without tension. [s]
double capillary_time_step(double tension, double density, double spacing);

}  // namespace kappaflow
