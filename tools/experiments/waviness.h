// How far surfaces are from those that they should be: along rays.
#pragma once

#include <span>
#include <vector>

#include "surface/field/field.h"

namespace kappaflow {

/// Where f falls to 0 on the way from x along a unit vector.
struct Crossing {
  double distance = 0;  ///< from x [m]; 0 where f <= 0 at x
  Vec3 normal = Vec3::Zero();
};
/// farthest: a distance at which f < 0 [m].
Crossing crossing(const Field& field, const Vec3& x, const Vec3& direction, double farthest);

/// Of a surface beside a smooth one.
struct Waviness {
  double height = 0;              ///< RMS of the distance between them [m]
  double normals = 0;             ///< RMS of the angle between their normals [degrees]
  std::vector<double> distances;  ///< of the surface from where the rays start [m]
};

/// Beside the surface that all rays meet at the same distance and at right angles.
Waviness waviness(const Field& field, std::span<const Vec3> from, std::span<const Vec3> direction,
                  double farthest);

/// Beside the polynomial of fourth degree in two coordinates that fits it best: of rays along `up`, whose
/// starting points differ along the axes a and b alone.
Waviness waviness_of_graph(const Field& field, std::span<const Vec3> from, int a, int b, const Vec3& up,
                           double farthest);

}  // namespace kappaflow
