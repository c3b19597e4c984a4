// The velocity of the material: what the other methods are measured against.
#pragma once

#include "surface/motion/velocity.h"

namespace kappaflow {

/// Method `material`: Eq. 4 with the tangential part of Field::material_velocity(). Confidence 1, since
/// nothing is guessed. Throws InvalidInput when the field knows no material velocity.
void evaluate_material(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       VelocitySpans result);

}  // namespace kappaflow
