// The prescribed motion of a rigid body, e.g. of a moving wall.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Where a body is: the point x of its rest position is at rotation x + translation.
struct RigidPose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();  ///< [m]

  Vec3 operator*(const Vec3& x) const { return rotation * x + translation; }
  /// The rest position of what is now at x.
  Vec3 inverse(const Vec3& x) const { return rotation.transpose() * (x - translation); }
};

/// A body's velocity field: linear + angular x (x - point).
struct RigidVelocity {
  Vec3 linear = Vec3::Zero();   ///< [m/s]
  Vec3 angular = Vec3::Zero();  ///< [rad/s]
  Vec3 point = Vec3::Zero();    ///< [m]

  Vec3 at(const Vec3& x) const;
};

/// A translation with a given velocity and a rotation about an axis through a point that takes part in the
/// translation. Both velocities are linear in time between the keys, constant before the first and after the
/// last.
struct BodyMotion {
  struct Key {
    double time = 0;              ///< [s]
    Vec3 velocity{0, 0, 0};       ///< [m/s]
    double angular_velocity = 0;  ///< about the axis, by the right-hand rule [rad/s]

    friend bool operator==(const Key&, const Key&) = default;
  };
  std::vector<Key> keys;  ///< times strictly increasing; empty: at rest
  Vec3 axis{0, 0, 1};     ///< of length 1
  Vec3 point{0, 0, 0};    ///< of the axis at t = 0 [m]

  bool at_rest() const { return keys.empty(); }
  RigidPose pose(double time) const;  ///< exact; the rest position at t = 0
  RigidVelocity velocity(double time) const;

  friend bool operator==(const BodyMotion&, const BodyMotion&) = default;
};

/// The surface in that pose.
TriangleSurface moved(TriangleSurface surface, const RigidPose& pose);

}  // namespace kappaflow
