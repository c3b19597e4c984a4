// The speed of a sphere on the axis of a cylinder of viscous liquid.
#pragma once

#include <cmath>

namespace kappaflow {

/// A sphere and the liquid around it.
struct SphereInJar {
  double radius = 0;           ///< [m]
  double jar_radius = 0;       ///< [m]
  double excess_density = 0;   ///< of the sphere over that of the liquid around it, any sign [kg/m3]
  double gravity = 0;          ///< [m/s2]
  double viscosity = 0;        ///< of the liquid around it, dynamic [Pa s]
  double inner_viscosity = 0;  ///< of the sphere's own liquid [Pa s]; infinite: it is solid

  /// Share of the surface's motion that the sphere's liquid does not hinder: 0 of a solid, 1 of a bubble.
  double freedom() const { return viscosity / (viscosity + inner_viscosity); }

  /// In liquid without bounds, positive downwards: Stokes' speed 2/9 excess g R^2 / viscosity times 3 / (3 -
  /// freedom) (Hadamard, "Mouvement permanent lent d'une sphere liquide et visqueuse dans un liquide
  /// visqueux", 1911; Rybczynski 1911) [m/s].
  double unbounded_speed() const {
    return 2.0 / 9 * excess_density * gravity * radius * radius / viscosity * 3 / (3 - freedom());
  }

  /// On the axis of the jar: Haberman & Sayre, "Motion of rigid and fluid spheres in stationary and moving
  /// liquids inside cylindrical tubes" (1958), the approximate formula, good to 0.3 percent for solid spheres
  /// up to 0.6 times as wide as the jar [m/s].
  double speed() const {
    const double l = radius / jar_radius, q = freedom(), l3 = l * l * l, l5 = l3 * l * l;
    const double above = 1 + 2.2757 * l5 * (2 * q - 1) / (3 - q),
                 below = 1 - 0.7017 * l * (3 - q) + 2.0865 * l3 * (1 - q) + 0.5689 * l5 * (5 * q - 3) -
                         0.72603 * l5 * l * (2 * q - 1);
    return unbounded_speed() * below / above;
  }
};

}  // namespace kappaflow
