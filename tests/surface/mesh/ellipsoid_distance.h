// Images of the signed distance from an ellipsoid, exactly.
#pragma once

#include <cmath>
#include <functional>

#include "surface/field/distance_field.h"

namespace kappaflow::testing {

/// Of the ellipsoid |x_i / a_i| = 1 from x, negative inside: the nearest point is p_i = a_i^2 x_i / (s +
/// a_i^2), s by bisection (Eberly).
inline double ellipsoid_distance(const Vec3& semi_axes, const Vec3& x) {
  const Vec3 square = semi_axes.cwiseAbs2(), y = x.cwiseAbs();
  const auto excess = [&](double s) {
    return (semi_axes.cwiseProduct(y).array() / (s + square.array())).matrix().squaredNorm() - 1;
  };
  double lower = -square.minCoeff() + 1e-12, upper = semi_axes.maxCoeff() * (y.norm() + 1);
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (lower + upper);
    (excess(middle) > 0 ? lower : upper) = middle;
  }
  const Vec3 nearest = square.cwiseProduct(y).array() / (lower + square.array());
  return std::copysign((y - nearest).norm(), lower);
}

/// Such an image of any distance, on a cube about the origin.
inline SignedDistances image_of(const std::function<double(const Vec3& x)>& distance, double half_width,
                                double spacing) {
  const int half = static_cast<int>(std::ceil(half_width / spacing));
  SignedDistances image{.grid = {.spacing = Vec3::Constant(spacing),
                                 .first = {-half, -half, -half},
                                 .dims = {2 * half + 1, 2 * half + 1, 2 * half + 1}},
                        .value = {}};
  for (int k = 0; k <= 2 * half; ++k)
    for (int j = 0; j <= 2 * half; ++j)
      for (int i = 0; i <= 2 * half; ++i)
        image.value.push_back(static_cast<float>(distance(image.grid.point(i, j, k))));
  return image;
}

}  // namespace kappaflow::testing
