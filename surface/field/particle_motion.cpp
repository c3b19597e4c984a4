#include "surface/field/particle_motion.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "surface/field/anisotropic_field.h"

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

/// Particles at one instant with their velocities.
FieldParticles instant(const Particles& particles, const ParticleFieldOptions& options,
                       std::vector<double> weights) {
  const std::size_t n = particles.size();
  return {.position = particles.position,
          .velocity = particles.velocity,
          .sigma = support_radii(n, options.sigma, particles.scale),
          .weight = std::move(weights),
          .weight_rate = std::vector<double>(n, 0.0),
          .cloud_speed = options.cloud_speed};
}

/// (after - before)/dt.
SymmetricMatrix rate(const SymmetricMatrix& before, const SymmetricMatrix& after, double dt) {
  SymmetricMatrix result;
  for (int ab = 0; ab < 6; ++ab) result[ab] = (after[ab] - before[ab]) / dt;
  return result;
}

/// Kernels of particles whose velocities are all that is known of their motion: their rates are the
/// difference to where they are when the fastest has gone a thousandth of a sigma.
FieldKernels kernels_of(const FieldParticles& particles, double threshold) {
  constexpr double kLookAhead = 0.001;  // [sigma]
  KernelShapes shapes = kernel_shapes(particles, threshold);
  const std::size_t n = particles.position.size();
  FieldKernels kernels{.center = particles.position,
                       .velocity = particles.velocity,
                       .shape = shapes.shape,
                       .shape_rate = std::vector<SymmetricMatrix>(n, SymmetricMatrix{}),
                       .weight = shapes.weight,
                       .weight_rate = std::vector<double>(n, 0.0)};
  double fastest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    fastest = std::max(fastest, particles.velocity[i].norm());
    kernels.center[i] += shapes.offset[i];
    if (particles.weight[i] != 0)
      kernels.weight_rate[i] = shapes.weight[i] / particles.weight[i] * particles.weight_rate[i];
  }
  if (!(fastest > 0)) return kernels;
  const double dt = kLookAhead * *std::ranges::min_element(particles.sigma) / fastest;
  FieldParticles later = particles;
  for (std::size_t i = 0; i < n; ++i) {
    later.position[i] += dt * particles.velocity[i];
    later.weight[i] += dt * particles.weight_rate[i];
  }
  const KernelShapes after = kernel_shapes(later, threshold);
  for (std::size_t i = 0; i < n; ++i) {
    kernels.velocity[i] += (after.offset[i] - shapes.offset[i]) / dt;
    kernels.shape_rate[i] = rate(shapes.shape[i], after.shape[i], dt);
    kernels.weight_rate[i] = (after.weight[i] - shapes.weight[i]) / dt;
  }
  return kernels;
}

}  // namespace

ParticleMotion::ParticleMotion(const Particles& at_t0, const Particles& at_t1,
                               const ParticleFieldOptions& options,
                               std::shared_ptr<const KernelShapes> shapes_t0)
    : t0_(at_t0.time), t1_(at_t1.time), options_(options), shapes_t0_(std::move(shapes_t0)) {
  check(options);
  check_particles(at_t0);
  check_particles(at_t1);
  if (!(t0_ < t1_))
    throw InvalidInput(
        fmt::format("a motion from {} s to {} s; its end must be later than its start", t0_, t1_));
  std::vector<double> weight_t0 = weights_of(at_t0, options_), weight_t1 = weights_of(at_t1, options_);
  pair_by_id(at_t0, at_t1, weight_t0, weight_t1);
  if (options_.kernels == Kernels::round) return;
  if (shapes_t0_ && shapes_t0_->size() != at_t0.size())
    throw InvalidInput(
        fmt::format("a motion of {} particles with {} kernels", at_t0.size(), shapes_t0_->size()));
  const auto shapes_of = [&](const Particles& particles, std::vector<double>& weights) {
    return std::make_shared<const KernelShapes>(
        kernel_shapes(instant(particles, options_, std::move(weights)), options_.threshold));
  };
  if (!shapes_t0_) shapes_t0_ = shapes_of(at_t0, weight_t0);
  shapes_t1_ = shapes_of(at_t1, weight_t1);
  pair_kernels(at_t0, at_t1);
}

void ParticleMotion::pair_kernels(const Particles& at_t0, const Particles& at_t1) {
  kernel_paths_.reserve(paths_.size());
  for (std::size_t i = 0, j = 0; i < at_t0.size() || j < at_t1.size();) {
    const bool in_t0 = i < at_t0.size() && (j == at_t1.size() || at_t0.id[i] <= at_t1.id[j]);
    const bool in_t1 = j < at_t1.size() && (i == at_t0.size() || at_t1.id[j] <= at_t0.id[i]);
    const KernelShapes &first = in_t0 ? *shapes_t0_ : *shapes_t1_, &last = in_t1 ? *shapes_t1_ : *shapes_t0_;
    const std::size_t at_first = in_t0 ? i : j, at_last = in_t1 ? j : i;
    kernel_paths_.push_back({.offset_t0 = first.offset[at_first],
                             .offset_t1 = last.offset[at_last],
                             .shape_t0 = first.shape[at_first],
                             .shape_t1 = last.shape[at_last],
                             .weight_t0 = in_t0 ? first.weight[at_first] : 0,
                             .weight_t1 = in_t1 ? last.weight[at_last] : 0});
    i += in_t0;
    j += in_t1;
  }
}

FieldKernels ParticleMotion::kernels_at(double t, const FieldParticles& particles) const {
  const std::size_t n = kernel_paths_.size();
  const double dt = t1_ - t0_, s = (t - t0_) / dt;
  FieldKernels kernels{.center = particles.position,
                       .velocity = particles.velocity,
                       .shape = std::vector<SymmetricMatrix>(n),
                       .shape_rate = std::vector<SymmetricMatrix>(n),
                       .weight = std::vector<double>(n),
                       .weight_rate = std::vector<double>(n)};
  parallel_for(n, [&](std::size_t i) {
    const KernelPath& path = kernel_paths_[i];
    kernels.center[i] += (1 - s) * path.offset_t0 + s * path.offset_t1;
    kernels.velocity[i] += (path.offset_t1 - path.offset_t0) / dt;
    for (int ab = 0; ab < 6; ++ab) kernels.shape[i][ab] = (1 - s) * path.shape_t0[ab] + s * path.shape_t1[ab];
    kernels.shape_rate[i] = rate(path.shape_t0, path.shape_t1, dt);
    kernels.weight[i] = (1 - s) * path.weight_t0 + s * path.weight_t1;
    kernels.weight_rate[i] = (path.weight_t1 - path.weight_t0) / dt;
  });
  return kernels;
}

void ParticleMotion::pair_by_id(const Particles& at_t0, const Particles& at_t1,
                                std::span<const double> weight_t0, std::span<const double> weight_t1) {
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
  const FieldParticles particles = particles_at(t);
  if (options_.kernels == Kernels::round)
    fields_.push_back(std::make_shared<ParticleField>(particles, options_.threshold, t));
  else
    fields_.push_back(
        std::make_shared<AnisotropicField>(particles, kernels_at(t, particles), options_.threshold, t));
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

std::shared_ptr<const Field> particle_field(const Particles& particles, const ParticleFieldOptions& options) {
  check(options);
  check_particles(particles);
  return particle_field(instant(particles, options, weights_of(particles, options)), options.kernels,
                        options.threshold, particles.time);
}

std::shared_ptr<const Field> particle_field(const FieldParticles& particles, Kernels kernels,
                                            double threshold, double time) {
  if (kernels == Kernels::round) return std::make_shared<ParticleField>(particles, threshold, time);
  return std::make_shared<AnisotropicField>(particles, kernels_of(particles, threshold), threshold, time);
}

}  // namespace kappaflow
