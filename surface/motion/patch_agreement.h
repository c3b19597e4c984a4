// Affine motions of neighbouring patches, brought to agree where the surface does not tell its motion.
#pragma once

#include <span>

#include "core/shared_loop.h"
#include "surface/mesh/surface_samples.h"
#include "surface/motion/affine_fit.h"

namespace kappaflow {

/// Moves the fits of patches whose rows are met badly towards those of their neighbours. Where liquid slides
/// along a wall, the wall gives the surface its shape: what the rows follow there is not the material, and
/// they say so by their residual. With r_s the residual of patch s, m the median of all, z_s = (a_s, G_s) and
/// z'_s as fitted, the patches with r_s > m go to the minimum of
///   sum_s (m/r_s)^2 (z_s - z'_s)^T N_s (z_s - z'_s)
///     + kappa sum_{s,t} (|u_s(y) - u_t(y)|^2 + L^2 |G_s - G_t|^2),   kappa = 0.003,
/// N_s the fit's information, (s, t) the pairs of patches that share an edge of the mesh, y halfway between
/// their samples, L the mean of their length scales; the other patches stay as they are. So a motion that is
/// affine all over stays what it is. Found by conjugate gradients, in an order that no thread changes. Local
/// fits joined by a global smoothness: Bruhn, Weickert & Schnoerr 2005 do so for images. length_scale: of
/// each patch [m], 0 where nothing was fitted; fastest: residuals below a thousandth of this speed count as
/// none [m/s]; shares: of the patches, of which the information is known to the process that has them.
/// Changes velocity and gradient of the fits.
void agree(const SurfaceSamples& samples, std::span<const double> length_scale, double fastest,
           std::span<AffineFit> fits, const ItemShares& shares = {});

}  // namespace kappaflow
