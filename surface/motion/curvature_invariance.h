// Eqs. 7-8 and 10: velocities that keep the curvatures of every surface point (Fujisawa et al. 2011).
#pragma once

#include "surface/motion/pointwise.h"

namespace kappaflow {

/// dK/dt = 0 and dH/dt = 0 as equations for the tangential velocity (Fujisawa et al. 2011, Eqs. 7-8):
///   L^3 grad K . E y = -L^3 (grad K . v_n + K_t),   L^2 grad H . E y = -L^2 (grad H . v_n + H_t),
/// L = jet.length_scale. Zero on a sphere, a plane and wherever one particle alone makes the surface.
/// Requires jet.g != 0.
TangentialRows<2> curvature_rows(const Jet& jet, const TangentBasis& basis, const Vec3& normal_velocity);

/// Method `curvature-only`: Eq. 4 with Eqs. 7-8.
void evaluate_curvature_only(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                             SurfaceVelocities& result);

/// Method `curvature`, the paper's: Eq. 4 with the least sum of squares of the residuals of Eqs. 5, 7 and 8
/// (Eq. 10).
void evaluate_curvature(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                        SurfaceVelocities& result);

}  // namespace kappaflow
