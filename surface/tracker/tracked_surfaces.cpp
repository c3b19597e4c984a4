#include "surface/tracker/tracked_surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/nearest_points.h"
#include "core/quantile.h"
#include "core/stopwatch.h"
#include "core/whole_within.h"
#include "surface/measure/surface_motion.h"
#include "surface/tracker/origin_map.h"

namespace kappaflow {
namespace {

constexpr int kMostSteps = 1000000;  // from one instant to the next

/// Particles without velocities say nothing about how fast their surface may be: it is what the motion of a
/// cloud allows.
double cloud_speed(bool is_cloud, double sigma, double t0, double t1) {
  return is_cloud ? kLargestCloudMotion * sigma / (t1 - t0) : 0;
}

/// 1 for each surface whose textures the particles give, or correct.
std::vector<char> from_particles(const SurfaceOptions& options) {
  std::vector<char> result;
  for (const SurfaceMethod& method : methods_of(options)) {
    const auto* fresh = std::get_if<FreshMesh>(&method);
    result.push_back(fresh != nullptr ? *fresh == FreshMesh::particles : options.anchor == Anchor::particles);
  }
  return result;
}

void find_nearest_sources(const Particles& particles, std::span<const int> source, bool anew,
                          TriangleMesh& mesh) {
  std::vector<std::size_t> unknown;
  std::vector<Vec3> place;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!anew && mesh.source[v] != kUnknownSource) continue;
    unknown.push_back(v);
    place.push_back(mesh.position[v]);
  }
  if (unknown.empty()) return;
  const std::vector<std::uint32_t> nearest = nearest_points(particles.position, place);
  for (std::size_t k = 0; k < unknown.size(); ++k) mesh.source[unknown[k]] = source[nearest[k]];
}

}  // namespace

ParticleFieldOptions field_options(const SurfaceOptions& options, std::span<const Vec3> first,
                                   std::span<const double> scale) {
  ParticleFieldOptions field;
  field.sigma = options.sigma * (options.spacing ? *options.spacing : particle_spacing(first, scale));
  field.weights = options.weights;
  field.kernels = options.kernels;
  field.threshold = options.threshold.value_or(0);
  if (!options.threshold) {
    const std::vector<double> weights = field_weights(first, field.sigma, field.weights, scale);
    field.threshold = half_median_threshold(first, weights, field.sigma, scale);
  }
  return field;
}

double fast_speed(const Particles& particles) {
  if (particles.velocity.empty()) return 0;
  std::vector<double> speed;
  speed.reserve(particles.size());
  for (const Vec3& v : particles.velocity) speed.push_back(v.norm());
  return quantile(speed, kShareOfFast);
}

TrackedSurfaces::TrackedSurfaces(Particles first, const SurfaceOptions& options)
    : TrackedSurfaces(std::move(first), start_of(first, nullptr, options), options) {}

TrackedSurfaces::TrackedSurfaces(Particles first, const Particles& next, const SurfaceOptions& options)
    : TrackedSurfaces(std::move(first), start_of(first, &next, options), options) {}

TrackedSurfaces::Start TrackedSurfaces::start_of(const Particles& first, const Particles* next,
                                                 const SurfaceOptions& options) {
  Start start{kappaflow::field_options(options, first.position, first.scale), nullptr};
  if (next == nullptr) {
    start.field = particle_field(first, start.options);
  } else {
    ParticleFieldOptions moving = start.options;
    moving.cloud_speed = cloud_speed(options.is_cloud, moving.sigma, first.time, next->time);
    start.field = ParticleMotion(first, *next, moving).at(first.time);
  }
  return start;
}

TrackedSurfaces::TrackedSurfaces(Particles&& first, Start start, const SurfaceOptions& options)
    : SurfaceGroup(std::move(start.field), start.options.sigma, options),
      particles_(std::move(first)),
      field_options_(start.options),
      is_cloud_(options.is_cloud),
      motion_per_step_(options.motion_per_step),
      name_(options.name),
      from_particles_(kappaflow::from_particles(options)) {
  if (std::ranges::count(from_particles_, 1) == 0) return;
  if (is_cloud_)
    throw InvalidInput(fmt::format("{}: textures from particles take particles with ids", name_));
  origins_.emplace().see(particles_);
}

double TrackedSurfaces::cloud_speed_to(const Particles& next) const {
  return cloud_speed(is_cloud_, field_options_.sigma, particles_.time, next.time);
}

ParticleMotion TrackedSurfaces::motion_to(const Particles& next) const {
  ParticleFieldOptions options = field_options_;
  options.cloud_speed = cloud_speed_to(next);
  return {particles_, next, options, shapes_};
}

int TrackedSurfaces::steps_to(const Particles& next, double speed) const {
  if (motion_per_step_ == kInfinity) return 1;
  if (speed == 0) speed = std::max(fast_speed(particles_), fast_speed(next));
  speed = std::max(speed, cloud_speed_to(next));
  const double steps = speed * (next.time - particles_.time) / (motion_per_step_ * field_options_.sigma);
  if (!(steps <= kMostSteps))
    throw InvalidInput(
        fmt::format("{}: particles at {:.3g} m/s move {:.3g} sigma from the instant {:.6g} s to the next; at "
                    "most {:.3g} are allowed",
                    name_, speed, steps * motion_per_step_, particles_.time, kMostSteps * motion_per_step_));
  return whole_within(std::ceil(steps), 1, kMostSteps);
}

bool TrackedSurfaces::step(Particles next, const Watch& watch, double speed) {
  ParticleMotion motion = motion_to(next);
  if (!step_through(motion, steps_to(next, speed), watch)) return false;
  particles_ = std::move(next);
  shapes_ = motion.shapes_t1();
  if (origins_) origins_->see(particles_);
  return true;
}

void TrackedSurfaces::go_on_with(Particles particles) {
  check_particles(particles);
  if (particles.time != particles_.time)
    throw InvalidInput(
        fmt::format("particles at {} s in place of those at {} s", particles.time, particles_.time));
  particles_ = std::move(particles);
  shapes_ = nullptr;  // are of the others
}

void TrackedSurfaces::settle(std::span<const int> source, bool anew) {
  settle_surfaces();
  find_sources(source, anew);
}

void TrackedSurfaces::advance(Particles next, std::span<const int> source) {
  step(std::move(next));
  settle(source);
}

void TrackedSurfaces::find_sources(std::span<const int> source, bool anew) {
  if (!source.empty())
    for (Surface& surface : surfaces_) find_nearest_sources(particles_, source, anew, mesh_of(surface));
  take_origins(source);
}

void TrackedSurfaces::take_origins(std::span<const int> source) {
  if (!origins_) return;
  const OriginMap map(particles_, origins_->of(particles_), source, field_options_.sigma);
  for (std::size_t m = 0; m < surfaces_.size(); ++m) {
    if (!from_particles_[m]) continue;
    const bool is_fresh = std::holds_alternative<FreshSurface>(surfaces_[m]);
    report_[m].texture_seconds += seconds_of(
        [&] { (is_fresh ? kappaflow::take_origins : correct_origins)(map, mesh_of(surfaces_[m])); });
  }
}

}  // namespace kappaflow
