// Contacts of rigid bodies among themselves and with walls, by Bullet.
#pragma once

#include <memory>
#include <span>

#include "core/solid_wall.h"
#include "solver/rigid_bodies.h"

namespace kappaflow {

/// Moves the bodies, so that they do not pass through walls or each other: contacts without restitution, with
/// Coulomb's friction. A convex surface collides as what it encloses, any other as its triangles. Bullet's
/// world is made anew in every step, and what contacts gave a body stands in RigidBodies: a run that resumes
/// is the same run.
class BodyCollisions {
 public:
  BodyCollisions(const RigidBodies& bodies, std::span<const SolidWall> walls, double spacing);
  ~BodyCollisions();
  BodyCollisions(BodyCollisions&&) noexcept;
  BodyCollisions& operator=(BodyCollisions&&) noexcept;

  /// Over the step from `time` to time + dt [s].
  void move(RigidBodies& bodies, double time, double dt);

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace kappaflow
