#include "surface/motion/material.h"

#include "core/errors.h"
#include "surface/motion/normal.h"
#include "surface/motion/pointwise.h"

namespace kappaflow {

void evaluate_material(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       SurfaceVelocities& result) {
  evaluate_pointwise(field, points, result, [&](const Vec3& x, const Jet& jet) {
    const std::optional<Vec3> material = field.material_velocity(x);
    if (!material)
      throw InvalidInput(
          "method material: the field has no particle velocities; choose a method that needs none");
    const Vec3 n = jet.g.normalized();
    const Vec3 tangential = *material - material->dot(n) * n;
    return PointVelocity{.velocity = normal_velocity(jet, options) + tangential, .confidence = 1};
  });
}

}  // namespace kappaflow
