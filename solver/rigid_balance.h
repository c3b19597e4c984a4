// Momentum that no error of a viscous solve can change.
#pragma once

#include <vector>

#include "solver/rigid_multigrid.h"

namespace kappaflow {

/// Adds to v, component by component of connected liquid, the rigid motion q that makes linear and angular
/// momentum right: with B from rigid motions about a point to velocities, sums over a component's particles,
///   sum B^T (v + B q - v*) = dt sum B^T (f - L (v + B q)),
/// where the forces between two of them cancel, and what walls and particles that are led do is left. v*:
/// particles.velocity. Preconditions: multigrid.build() for the same arguments.
void balance_momentum(const RigidMultigrid& multigrid, const ViscousForces& forces,
                      const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                      float time_step, std::vector<Vec4f>& v);

}  // namespace kappaflow
