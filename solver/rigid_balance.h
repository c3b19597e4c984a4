// Momentum that no error of a viscous solve can change.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.h"
#include "solver/body_drag.h"
#include "solver/rigid_multigrid.h"

namespace kappaflow {

/// Adds to v, component by component of connected liquid, the rigid motion q that makes linear and angular
/// momentum right: with B from rigid motions about a point to velocities, sums over a component's particles,
///   sum B^T m (v + B q - v*) = dt sum B^T (f - L (v + B q)),
/// where the forces between two of them cancel, and what walls and particles that are led do is left. Liquid
/// that touches a rigid body is connected by it; f is then that of the body's response to q. Keeps its
/// buffers, so that a step allocates nothing once warm.
class MomentumBalance {
 public:
  /// v*: particles.velocity. Precondition: multigrid.build() for the same arguments.
  void restore(RigidMultigrid& multigrid, const ViscousForces& forces, const FluidParticles& particles,
               const NeighbourLists& lists, const WallSums& walls, const BodyDrag& bodies, float time_step,
               std::vector<Vec4f>& v);

  std::size_t bytes() const { return bytes_of(component_, order_, joined_, cell_, component_of_body_); }

 private:
  /// Two components that are parts of one. A body counts as a component that has no cells.
  struct Joint {
    std::uint64_t a = 0, b = 0;
    auto operator<=>(const Joint&) const = default;
  };

  void join(RigidMultigrid& multigrid, const ViscousForces& forces, const FluidParticles& particles,
            const BodyDrag& bodies);
  void join_over_borders(RigidMultigrid& multigrid, std::vector<Joint>& joints);
  void join_by_bodies(const RigidMultigrid& multigrid, const ViscousForces& forces,
                      const FluidParticles& particles, const BodyDrag& bodies, std::vector<Joint>& joints);
  void sort_cells(const RigidLevel& level);

  std::vector<std::uint64_t> component_;  // of each cell: the key of its first cell
  std::vector<std::uint32_t> order_;      // this rank's cells, component by component
  std::vector<std::uint64_t> joined_;     // components that have become one with others, ascending
  // Where there are rigid bodies:
  std::vector<std::uint32_t> cell_;               // of each particle
  std::vector<std::uint64_t> component_of_body_;  // itself: it touches none
};

}  // namespace kappaflow
