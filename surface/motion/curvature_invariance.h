// Eqs. 7-8 and 10: velocities that keep the curvatures of every surface point (Fujisawa et al. 2011).
#pragma once

#include "surface/motion/tangential.h"

namespace kappaflow {

/// dK/dt = 0 and dH/dt = 0 as equations for the tangential velocity (Fujisawa et al. 2011, Eqs. 7-8):
///   L^3 grad K . E y = -L^3 (grad K . v_n + K_t),   L^2 grad H . E y = -L^2 (grad H . v_n + H_t),
/// L = length [m], see row_length(). Zero on a sphere, a plane and wherever one particle alone makes the
/// surface. Requires jet.g != 0.
TangentialRows<2> curvature_rows(const Jet& jet, const TangentBasis& basis, const Vec3& normal_velocity,
                                 double length);

/// Method `curvature-only`: Eq. 4 with Eqs. 7-8.
void evaluate_curvature_only(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                             VelocitySpans result);

/// Method `curvature`, the paper's: Eq. 4 with the least sum of squares of the residuals of Eqs. 5, 7 and 8
/// (Eq. 10), as VelocityOptions::row_scale weighs them.
void evaluate_curvature(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                        VelocitySpans result);

/// Method `curvature-first`: under rotation Eq. 5 contradicts Eqs. 7-8, so their sum is biased. Here the
/// curvature rows decide the directions v_k that they determine, and Eq. 5 fills the rest:
///   y = sum_k v_k (p_k y_c . v_k + (1 - p_k) y_t . v_k),   p_k = s_k^2/(s_k^2 + mu^2),   mu = 3 damping,
/// y_c and y_t the solutions of Eqs. 7-8 and of Eq. 5, s_k and v_k the singular values and right singular
/// vectors of the curvature rows. Confidence: that of all rows together.
void evaluate_curvature_first(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                              VelocitySpans result);

}  // namespace kappaflow
