#include "core/body_motion.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace kappaflow {
namespace {

using Key = BodyMotion::Key;

Key interpolated(const std::vector<Key>& keys, double time) {
  const auto next = std::find_if(keys.begin(), keys.end(), [=](const Key& key) { return key.time > time; });
  if (next == keys.begin()) return keys.front();
  if (next == keys.end()) return keys.back();
  const Key &a = *(next - 1), &b = *next;
  const double s = (time - a.time) / (b.time - a.time);
  return {time, (1 - s) * a.velocity + s * b.velocity, (1 - s) * a.angular_velocity + s * b.angular_velocity};
}

/// Path and angle between two times between which the velocities are linear.
Key trapezoid(const Key& a, const Key& b) {
  const double half = 0.5 * (b.time - a.time);
  return {0, half * (a.velocity + b.velocity), half * (a.angular_velocity + b.angular_velocity)};
}

/// Path and angle from the first key's time to `time`.
Key integral(const std::vector<Key>& keys, double time) {
  const Key end = interpolated(keys, time);
  Key sum, last = keys.front();
  const auto add = [&](const Key& next) {
    const Key part = trapezoid(last, next);
    sum.velocity += part.velocity;
    sum.angular_velocity += part.angular_velocity;
    last = next;
  };
  for (const Key& key : keys)
    if (key.time < time) add(key);
  add({time, end.velocity, end.angular_velocity});
  return sum;
}

/// Path [m] and angle [rad] from t = 0 on.
Key path(const std::vector<Key>& keys, double time) {
  const Key to = integral(keys, time), from = integral(keys, 0);
  return {time, to.velocity - from.velocity, to.angular_velocity - from.angular_velocity};
}

}  // namespace

Vec3 RigidVelocity::at(const Vec3& x) const {
  return linear + angular.cross(x - point);
}

RigidPose BodyMotion::pose(double time) const {
  if (at_rest()) return {};
  const Key moved = path(keys, time);
  const Mat3 rotation = Eigen::AngleAxisd(moved.angular_velocity, axis).toRotationMatrix();
  return {rotation, point + moved.velocity - rotation * point};
}

RigidVelocity BodyMotion::velocity(double time) const {
  if (at_rest()) return {};
  const Key now = interpolated(keys, time);
  return {now.velocity, now.angular_velocity * axis, point + path(keys, time).velocity};
}

TriangleSurface moved(TriangleSurface surface, const RigidPose& pose) {
  for (Vec3& x : surface.vertices) x = pose * x;
  return surface;
}

}  // namespace kappaflow
