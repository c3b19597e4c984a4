// Particles between two instants: cubic Hermite paths, so that a Runge-Kutta stage has particles at its own time.
#pragma once

#include "surface/field/particle_field.h"

namespace kappaflow {

/// How particles become a field.
struct ParticleFieldOptions {
  double sigma = 0;                             ///< support radius [m], > 0
  WeightRule weights = WeightRule::uniform;     ///< see WeightRule
  double threshold = 0;                         ///< T of Eq. 12 [-]
};

/// Eq. 12 on [t0, t1]. Particles are paired by id; x_i(t) is the cubic Hermite interpolant of positions and
/// velocities at both ends and v_i(t) its derivative; weights are linear in time. A particle that is present at one
/// end only moves with its velocity there while its weight ramps linearly to (or from) zero.
class ParticleMotion final : public FieldMotion {
 public:
  /// Throws InvalidInput unless at_t0.time < at_t1.time. Both are copied as far as they are needed.
  ParticleMotion(const Particles& at_t0, const Particles& at_t1, const ParticleFieldOptions& options);

  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  std::shared_ptr<const Field> at(double t) override;

 private:
  FieldParticles particles_at(double t) const;

  double t0_, t1_;
  ParticleFieldOptions options_;
  // Paired arrays, one entry a particle that is present at either end.
  std::vector<Vec3> position_t0_, position_t1_, velocity_t0_, velocity_t1_;
  std::vector<double> weight_t0_, weight_t1_;
  std::vector<std::shared_ptr<const ParticleField>> fields_;  // those asked for so far
};

/// The field of particles at rest in time, i.e. at one instant with their velocities.
std::shared_ptr<const ParticleField> particle_field(const Particles& particles, const ParticleFieldOptions& options);

}  // namespace kappaflow
