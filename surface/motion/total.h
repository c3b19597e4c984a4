// Eq. 5: the total velocity of Stam & Schmidt 2011, which keeps the normal of every surface point.
#pragma once

#include "surface/motion/tangential.h"

namespace kappaflow {

/// dn/dt = 0 as equations for the tangential velocity (Stam & Schmidt 2011; Fujisawa et al. 2011, Eq. 5):
///   L E^T A E y / |g| = -L E^T (A v_n + g_t) / |g|,   L = length [m], see row_length().
/// Singular where K = 0. Requires jet.g != 0.
TangentialRows<2> total_rows(const Jet& jet, const TangentBasis& basis, const Vec3& normal_velocity,
                             double length);

/// Method `total`: Eq. 4 with Eq. 5.
void evaluate_total(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                    VelocitySpans result);

}  // namespace kappaflow
