// How far fairing may move each vertex: a vertex whose velocity is well determined holds its place.
#pragma once

#include <span>

#include "core/connectivity.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

/// 1 - c^2 for a vertex of confidence c = s/sqrt(s^2 + lambda^2): the share lambda^2/(s^2 + lambda^2) of its
/// tangential velocity along the worst direction that the damping took away. Outliers get 1: their rows
/// settled on a velocity that their neighbourhood contradicts (the wrong minima of Fujisawa et al. 2011,
/// section 5). mobility: one entry a vertex. Does not depend on the order of the vertices.
void vertex_mobility(const VertexRings& rings, const SurfaceVelocities& velocities,
                     std::span<double> mobility);

/// Whether the velocity of vertex v differs from the mean of its neighbours', weighted by c^2, by more than
/// three times the median difference of theirs from it, and by more than a tenth of the mean speed around.
bool is_outlier(const VertexRings& rings, const SurfaceVelocities& velocities, int v);

}  // namespace kappaflow
