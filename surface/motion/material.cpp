#include "surface/motion/material.h"

#include <algorithm>

#include "core/errors.h"
#include "surface/motion/normal.h"
#include "surface/motion/pointwise.h"

namespace kappaflow {

namespace {

/// Where the material carries f there is nothing to correct, and no jet to evaluate.
void evaluate_carried(const Field& field, std::span<const Vec3> position, VelocitySpans result) {
  std::ranges::fill(result.confidence, 1);
  shared_for(
      position.size(),
      [&](std::size_t i) {
        result.velocity[i] = field.material_velocity(position[i]).value_or(Vec3::Zero());
      },
      kDefaultGrain, result.velocity);
}

}  // namespace

void evaluate_material(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       VelocitySpans result) {
  if (field.moves_with_material()) {
    evaluate_carried(field, points.position, result);
    return;
  }
  evaluate_each(points, result, [&](const Vec3& x) -> PointVelocity {
    const auto [jet, material] = field.moving_point(x);
    if (!has_gradient(jet)) return {};
    if (!material)
      throw InvalidInput(
          "method material: the field has no particle velocities; choose a method that needs none");
    const Vec3 n = jet.g.normalized();
    const Vec3 tangential = *material - material->dot(n) * n;
    return {.velocity = normal_velocity(jet, options) + tangential, .confidence = 1};
  });
}

}  // namespace kappaflow
