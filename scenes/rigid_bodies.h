// Bodies of a scene at its start.
#pragma once

#include <span>

#include "core/solid_wall.h"
#include "scenes/scene.h"
#include "solver/rigid_body.h"

namespace kappaflow {

/// Throws InvalidInput at the scene's line for a body that reaches into a wall or an earlier body by more
/// than 0.05 spacings; they may touch. walls, bodies: those of the scene.
void check_apart(const Scene& scene, std::span<const SolidWall> walls, std::span<const RigidBody> bodies);

}  // namespace kappaflow
