// A rigid body that liquid moves, and that moves liquid.
#pragma once

#include "core/body_motion.h"
#include "core/solid_wall.h"
#include "core/types.h"
#include "solver/heat_options.h"

namespace kappaflow {

/// A body of the same density everywhere in it.
struct RigidBody {
  SolidWall solid;                 ///< where it is at t = 0; without a motion
  double mass = 0;                 ///< > 0 [kg]
  Vec3 velocity{0, 0, 0};          ///< of its centre of mass at t = 0 [m/s]
  Vec3 angular_velocity{0, 0, 0};  ///< at t = 0 [rad/s]
  double friction = 0.5;           ///< Coulomb's, on walls; between two bodies the product of theirs [1]
  WallHeat heat{};                 ///< what it is for the liquid's heat
};

/// What the space in a closed surface weighs.
struct MassProperties {
  double volume = 0;            ///< [m3]
  Vec3 centre = Vec3::Zero();   ///< [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre, over the mass [m2]
};
/// Of the union of the solid's parts where they do not overlap. Exact for the triangles.
MassProperties mass_properties(const TriangleSurface& surface);

/// Where a body is and how it moves.
struct BodyState {
  RigidPose pose;          ///< of its position at t = 0
  RigidVelocity velocity;  ///< its point: the centre of mass
};

}  // namespace kappaflow
