// Walls and rigid bodies as the solver takes them: as particles.
#pragma once

#include <span>
#include <vector>

#include "core/solid_wall.h"
#include "solver/boundary.h"
#include "solver/rigid_body.h"

namespace kappaflow {

/// One body for each motion of the walls, then the rigid ones. heat: of the walls, as far as it goes.
std::vector<WallBody> wall_bodies(std::span<const SolidWall> walls, std::span<const WallHeat> heat,
                                  std::span<const RigidBody> rigid, double spacing);

/// The walls and the bodies at t = 0.
std::vector<SolidWall> all_solids(std::span<const SolidWall> walls, std::span<const RigidBody> bodies);

}  // namespace kappaflow
