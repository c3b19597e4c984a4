#include "surface/field/particle_motion.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace kappaflow {

namespace {

void check(const ParticleFieldOptions& options) {
  if (!(options.sigma > 0))
    throw InvalidInput(fmt::format("the field's sigma is {}; it must be positive", options.sigma));
  if (!(options.threshold > 0))
    throw InvalidInput(fmt::format("the field's threshold is {}; it must be positive", options.threshold));
}

std::vector<double> weights_of(const Particles& particles, const ParticleFieldOptions& options) {
  return field_weights(particles.position, options.sigma, options.weights, particles.scale);
}

double scale_of(const Particles& particles, std::size_t i) {
  return particles.scale.empty() ? 1 : particles.scale[i];
}

}  // namespace

ParticleMotion::ParticleMotion(const Particles& at_t0, const Particles& at_t1,
                               const ParticleFieldOptions& options)
    : t0_(at_t0.time), t1_(at_t1.time), options_(options) {
  check(options);
  check_particles(at_t0);
  check_particles(at_t1);
  if (!(t0_ < t1_))
    throw InvalidInput(
        fmt::format("a motion from {} s to {} s; its end must be later than its start", t0_, t1_));
  pair_by_id(at_t0, at_t1);
}

void ParticleMotion::pair_by_id(const Particles& at_t0, const Particles& at_t1) {
  const std::vector<double> weight_t0 = weights_of(at_t0, options_), weight_t1 = weights_of(at_t1, options_);
  const double dt = t1_ - t0_;
  paths_.reserve(std::max(at_t0.size(), at_t1.size()));
  for (std::size_t i = 0, j = 0; i < at_t0.size() || j < at_t1.size();) {
    const bool in_t0 = i < at_t0.size() && (j == at_t1.size() || at_t0.id[i] <= at_t1.id[j]);
    const bool in_t1 = j < at_t1.size() && (i == at_t0.size() || at_t1.id[j] <= at_t0.id[i]);
    Path path;
    if (in_t0) path.position_t0 = at_t0.position[i], path.velocity_t0 = at_t0.velocity[i];
    if (in_t1) path.position_t1 = at_t1.position[j], path.velocity_t1 = at_t1.velocity[j];
    if (!in_t0)
      path.position_t0 = path.position_t1 - dt * path.velocity_t1, path.velocity_t0 = path.velocity_t1;
    if (!in_t1)
      path.position_t1 = path.position_t0 + dt * path.velocity_t0, path.velocity_t1 = path.velocity_t0;
    path.sigma = options_.sigma * (in_t0 ? scale_of(at_t0, i) : scale_of(at_t1, j));
    path.weight_t0 = in_t0 ? weight_t0[i++] : 0;
    path.weight_t1 = in_t1 ? weight_t1[j++] : 0;
    paths_.push_back(path);
  }
}

FieldParticles ParticleMotion::particles_at(double t) const {
  const std::size_t n = paths_.size();
  const double dt = t1_ - t0_, s = (t - t0_) / dt;
  const double h01 = s * s * (3 - 2 * s), h10 = s * (1 - s) * (1 - s), h11 = s * s * (s - 1);
  const double dh01 = 6 * s * (1 - s), dh10 = (1 - s) * (1 - 3 * s), dh11 = s * (3 * s - 2);
  FieldParticles p{.position = std::vector<Vec3>(n),
                   .velocity = std::vector<Vec3>(n),
                   .sigma = std::vector<double>(n),
                   .weight = std::vector<double>(n),
                   .weight_rate = std::vector<double>(n),
                   .cloud_speed = options_.cloud_speed};
  parallel_for(n, [&](std::size_t i) {
    const Path& path = paths_[i];
    const Vec3 moved = path.position_t1 - path.position_t0;
    p.position[i] = path.position_t0 + h01 * moved + dt * (h10 * path.velocity_t0 + h11 * path.velocity_t1);
    p.velocity[i] = dh01 / dt * moved + dh10 * path.velocity_t0 + dh11 * path.velocity_t1;
    p.sigma[i] = path.sigma;
    p.weight[i] = (1 - s) * path.weight_t0 + s * path.weight_t1;
    p.weight_rate[i] = (path.weight_t1 - path.weight_t0) / dt;
  });
  return p;
}

std::shared_ptr<const Field> ParticleMotion::at(double t) {
  if (!(t >= t0_ && t <= t1_))
    throw InvalidInput(fmt::format("a field at {} s was asked of a motion from {} s to {} s", t, t0_, t1_));
  for (const auto& field : fields_)
    if (field->time() == t) return field;
  fields_.push_back(std::make_shared<ParticleField>(particles_at(t), options_.threshold, t));
  return fields_.back();
}

void ParticleMotion::forget_before(double t) {
  std::erase_if(fields_, [t](const auto& field) { return field->time() < t; });
}

MotionPart::MotionPart(FieldMotion& whole, double t0, double t1) : whole_(whole), t0_(t0), t1_(t1) {
  if (!(whole.t0() <= t0 && t0 < t1 && t1 <= whole.t1()))
    throw InvalidInput(fmt::format("a step from {} s to {} s through a motion from {} s to {} s", t0, t1,
                                   whole.t0(), whole.t1()));
}

std::shared_ptr<const ParticleField> particle_field(const Particles& particles,
                                                    const ParticleFieldOptions& options) {
  check(options);
  check_particles(particles);
  const std::size_t n = particles.size();
  FieldParticles p{.position = particles.position,
                   .velocity = particles.velocity,
                   .sigma = support_radii(n, options.sigma, particles.scale),
                   .weight = weights_of(particles, options),
                   .weight_rate = std::vector<double>(n, 0.0),
                   .cloud_speed = options.cloud_speed};
  return std::make_shared<ParticleField>(p, options.threshold, particles.time);
}

}  // namespace kappaflow
