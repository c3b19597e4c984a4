// Liquids whose viscosity depends on the rate at which they are sheared.
#pragma once

#include <variant>

namespace kappaflow {

// The laws give the kinematic viscosity nu [m2/s] at the shear rate g = sqrt(2 D : D) >= 0 [1/s], D the rate
// of strain: in simple shear g is the velocity's gradient, and nu g the shear stress over the density. The
// stress rises with g, and nu is finite at every g.

/// Herschel & Bulkley, "Konsistenzmessungen von Gummi-Benzolloesungen" (1926), regularised:
///   nu(g) = k (g^2 + 1/m^2)^((n - 1)/2) + tau (1 - exp(-m g)) / g,   nu(0) = k m^(1 - n) + tau m.
/// A power law where tau is 0, the liquid of Bingham (1922) where n is 1. The second term is that of
/// Papanastasiou, "Flows of materials with yield" (1987): at rates far above 1/m the stress is tau + k g^n;
/// below, what should be at rest creeps with the viscosity nu(0).
struct HerschelBulkley {
  double yield_stress = 0;       ///< tau, over the density; >= 0 [m2/s2]
  double consistency = 0;        ///< k, over the density; > 0 [m2 s^(n - 2)]
  double index = 1;              ///< n > 0; below 1 the liquid thins when sheared, above it thickens
  double regularisation = 1000;  ///< m > 0 [s]
};

/// Carreau, "Rheological equations from molecular network theories" (1972):
///   nu(g) = b + (a - b) (1 + (t g)^2)^((n - 1)/2).
struct Carreau {
  double at_rest = 1;  ///< a, > 0 [m2/s]
  double sheared = 0;  ///< b, of fast shear, in [0, a] [m2/s]
  double time = 1;     ///< t > 0 [s]: thins from the rate 1 / t on
  double index = 0.5;  ///< n, in (0, 1]
};

/// Cross, "Rheology of non-Newtonian fluids: a new flow equation for pseudoplastic systems" (1965):
///   nu(g) = b + (a - b) / (1 + (t g)^p).
struct Cross {
  double at_rest = 1;   ///< a, > 0 [m2/s]
  double sheared = 0;   ///< b, of fast shear, in [0, a] [m2/s]
  double time = 1;      ///< t > 0 [s]
  double exponent = 1;  ///< p, in (0, 1]
};

/// Nothing: Newtonian.
using Rheology = std::variant<std::monostate, HerschelBulkley, Carreau, Cross>;

inline bool is_newtonian(const Rheology& law) {
  return law.index() == 0;
}

/// nu(g) [m2/s]. Precondition: not Newtonian.
double viscosity_at(const Rheology& law, double shear_rate);

/// Throws InvalidInput for numbers out of range.
void check_rheology(const Rheology& law);

}  // namespace kappaflow
