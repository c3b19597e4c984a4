// Particles between two instants: cubic Hermite paths, so that a Runge-Kutta stage has particles at its own
// time.
#pragma once

#include "surface/field/kernel_shapes.h"
#include "surface/field/particle_field.h"
#include "surface/field/particle_weights.h"

namespace kappaflow {

/// So many particles count where the fastest set the length of a step: a few fly off.
inline constexpr double kShareOfFast = 0.999;

/// How particles become a field.
struct ParticleFieldOptions {
  double sigma = 0;                          ///< support radius of particles of scale 1 [m], > 0
  WeightRule weights = WeightRule::uniform;  ///< see WeightRule
  double threshold = 0;                      ///< T of Eq. 12 [-], > 0
  double cloud_speed = 0;                    ///< see FieldParticles
  Kernels kernels = Kernels::round;          ///< see kernel_shapes()
};

/// Eq. 12 on [t0, t1]. Particles are paired by id; x_i(t) is the cubic Hermite interpolant of positions and
/// velocities at both ends and v_i(t) its derivative; weights are linear in time, and their rate is part of
/// the field's time derivatives. A particle that is present at one end only moves with its velocity there
/// while its weight ramps linearly to (or from) zero. Its scale is that at t0. Particles of which none is
/// present at both ends, all at rest (a point cloud), give the mean of the two fields weighted by time: f_t =
/// (f_1 - f_0)/(t1 - t0). Kernels that are not round are made at both ends: their offsets from the particles,
/// shapes and weights are linear in time between.
class ParticleMotion final : public FieldMotion {
 public:
  /// Throws InvalidInput unless at_t0.time < at_t1.time, both pass check_particles(), and sigma and threshold
  /// are positive.
  /// shapes_t0: shapes_t1() of the motion before, which saves making them again; InvalidInput where it is of
  /// another number of particles.
  ParticleMotion(const Particles& at_t0, const Particles& at_t1, const ParticleFieldOptions& options,
                 std::shared_ptr<const KernelShapes> shapes_t0 = nullptr);

  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  /// Builds the field at its first use and keeps it as long as the motion lives. Throws InvalidInput outside
  /// [t0, t1].
  std::shared_ptr<const Field> at(double t) override;
  void forget_before(double t) override;

  /// Of the particles at t1; nullptr where kernels are round.
  std::shared_ptr<const KernelShapes> shapes_t1() const { return shapes_t1_; }

 private:
  /// A particle at both ends of the step.
  struct Path {
    Vec3 position_t0, position_t1, velocity_t0, velocity_t1;
    double weight_t0, weight_t1;
    double sigma;
  };

  /// The kernel of one.
  struct KernelPath {
    Vec3 offset_t0, offset_t1;
    SymmetricMatrix shape_t0, shape_t1;
    double weight_t0, weight_t1;
  };

  void pair_by_id(const Particles& at_t0, const Particles& at_t1, std::span<const double> weight_t0,
                  std::span<const double> weight_t1);
  void pair_kernels(const Particles& at_t0, const Particles& at_t1);
  FieldParticles particles_at(double t) const;
  FieldKernels kernels_at(double t, const FieldParticles& particles) const;

  double t0_, t1_;
  ParticleFieldOptions options_;
  std::vector<Path> paths_;  // one a particle that is present at either end, by id
  std::shared_ptr<const KernelShapes> shapes_t0_, shapes_t1_;
  std::vector<KernelPath> kernel_paths_;              // one a path, or none
  std::vector<std::shared_ptr<const Field>> fields_;  // those asked for so far
};

/// One step of several through a longer motion, which must outlive it.
class MotionPart final : public FieldMotion {
 public:
  /// Throws InvalidInput unless whole.t0() <= t0 < t1 <= whole.t1().
  MotionPart(FieldMotion& whole, double t0, double t1);

  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  std::shared_ptr<const Field> at(double t) override { return whole_.at(t); }

 private:
  FieldMotion& whole_;
  double t0_, t1_;
};

/// The field of particles at one instant, moving with their velocities while their weights stay as they are;
/// kernels that are not round change as they do when the particles go on. Throws InvalidInput as
/// ParticleMotion does.
std::shared_ptr<const Field> particle_field(const Particles& particles, const ParticleFieldOptions& options);
/// The same, of particles that have all that a field takes.
std::shared_ptr<const Field> particle_field(const FieldParticles& particles, Kernels kernels,
                                            double threshold, double time);

}  // namespace kappaflow
