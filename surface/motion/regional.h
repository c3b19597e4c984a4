// The velocity of a neighbourhood: many surface points vote for one local affine motion.
#pragma once

#include "surface/motion/velocity.h"

namespace kappaflow {

/// Method `regional`: Eq. 4 with the tangential part of the affine motion u(y) = a + G (y - x) that carries f
/// and its Hessian best over a window of the surface, see affine_fit.h and docs/regional.md:
///   minimise over a, G   sum_j w_j |rows(y_j) (a, G)|^2 / sum_j w_j + |Lambda (a, r G)|^2,
///   w_j = area_j (1 - |y_j - x|^2/r^2)^2.
/// The window holds the points that are connected to x along the mesh within r = 1.25 jet.length_scale; where
/// they do not determine the tangential velocity it grows, to twice the radius at most. The weight is taken
/// per patch of half a length scale, each patch's rows summed exactly, so that the cost of a vertex does not
/// depend on the density of the mesh. Patches whose rows are met badly follow their neighbours: agree() of
/// patch_agreement.h. Exact for rigid motions; for every affine motion of the material where
/// the field knows its StrainResponse.
/// Confidence: AffineFit::determined as s in s/sqrt(s^2 + damping^2); the damping is used for nothing else.
/// A point without neighbours is a window by itself.
void evaluate_regional(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       VelocitySpans result);

}  // namespace kappaflow
