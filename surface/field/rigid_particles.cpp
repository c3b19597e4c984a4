#include "surface/field/rigid_particles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.h"

namespace kappaflow {

Mat3 SteadyMotion::rotation(double t) const {
  const double rate = angular_velocity.norm();
  if (rate == 0) return Mat3::Identity();
  return Eigen::AngleAxisd(rate * t, angular_velocity / rate).toRotationMatrix();
}

RigidParticles::RigidParticles(FieldParticles at_rest, double threshold, const SteadyMotion& motion,
                               double t0, double t1)
    : at_rest_(std::move(at_rest)), threshold_(threshold), motion_(motion), t0_(t0), t1_(t1) {
  if (!(t0 < t1)) throw InvalidInput(fmt::format("a step from t = {} s to {} s does not go forward", t0, t1));
  at_rest_.velocity.resize(at_rest_.position.size());
}

std::shared_ptr<const Field> RigidParticles::at(double t) {
  const auto known = std::ranges::find(fields_, t, &ParticleField::time);
  if (known != fields_.end()) return *known;
  FieldParticles now = at_rest_;
  const Mat3 R = motion_.rotation(t);
  for (std::size_t i = 0; i < now.position.size(); ++i) {
    const Vec3 turned = R * at_rest_.position[i];
    now.position[i] = turned + t * motion_.velocity;
    now.velocity[i] = motion_.angular_velocity.cross(turned) + motion_.velocity;
  }
  fields_.push_back(std::make_shared<ParticleField>(now, threshold_, t));
  return fields_.back();
}

}  // namespace kappaflow
