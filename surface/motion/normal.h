// Eq. 4: the normal velocity, which every method shares.
#pragma once

#include "surface/motion/velocity.h"

namespace kappaflow {

/// v_n = -f_t g/|g|^2 [m/s] (Fujisawa et al. 2011, Eq. 4), the velocity at which the level set moves along
/// its normal. Its length is limited to options.speed_limit times the fastest speed in reach: where a piece
/// of the surface is about to vanish, |f_t|/|g| has no bound. Requires jet.g != 0.
Vec3 normal_velocity(const Jet& jet, const VelocityOptions& options);

/// Method `normal`: Eq. 4 and no tangential motion. Confidence 0, since nothing determines the tangential
/// part.
void evaluate_normal(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                     VelocitySpans result);

}  // namespace kappaflow
