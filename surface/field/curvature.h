// Gaussian and mean curvature of the level set through a point, with gradient and rate of change.
#pragma once

#include "surface/field/jet.h"

namespace kappaflow {

/// K, H and their derivatives. H > 0 on a sphere (1/R), K = 1/R^2 there.
struct CurvatureJet {
  double K = 0;                ///< Gaussian curvature [1/m2]
  double H = 0;                ///< mean curvature [1/m]
  Vec3 grad_K = Vec3::Zero();  ///< [1/m3]
  Vec3 grad_H = Vec3::Zero();  ///< [1/m2]
  double K_t = 0;              ///< partial time derivative at fixed x [1/(m2 s)]
  double H_t = 0;              ///< [1/(m s)]
};

/// Requires jet.g != 0. K = g^T adj(A) g / |g|^4, H = -(tr(A)|g|^2 - g^T A g) / (2 |g|^3); derivatives by the
/// chain rule. (The paper's Eqs. 6 and 9, whose Eq. 9 has the opposite sign of H.)
CurvatureJet curvature_jet(const Jet& jet);

}  // namespace kappaflow
