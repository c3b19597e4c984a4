// A body of particles in an exactly known rigid motion: what tracked surfaces are measured against.
#pragma once

#include "surface/field/particle_field.h"

namespace kappaflow {

/// x(t) = R(t) x(0) + t velocity, R(t) the rotation about the origin by the angle |angular_velocity| t.
struct SteadyMotion {
  Vec3 velocity = Vec3::Zero();          ///< [m/s]
  Vec3 angular_velocity = Vec3::Zero();  ///< [1/s]

  Mat3 rotation(double t) const;  ///< R(t)
  Vec3 position(const Vec3& x0, double t) const { return rotation(t) * x0 + t * velocity; }
};

/// Eq. 12 on [t0, t1] for particles that move rigidly. Positions and velocities are exact at every t: no
/// error of an interpolation in time is mistaken for one of the tracked surface.
class RigidParticles final : public FieldMotion {
 public:
  /// at_rest: the particles at t = 0; their velocities are ignored. Throws InvalidInput as ParticleField
  /// does, and unless t0 < t1.
  RigidParticles(FieldParticles at_rest, double threshold, const SteadyMotion& motion, double t0, double t1);

  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  /// Of any t: the motion does not end.
  std::shared_ptr<const Field> at(double t) override;

 private:
  FieldParticles at_rest_;
  double threshold_;
  SteadyMotion motion_;
  double t0_, t1_;
  std::vector<std::shared_ptr<const ParticleField>> fields_;  // those asked for so far
};

}  // namespace kappaflow
