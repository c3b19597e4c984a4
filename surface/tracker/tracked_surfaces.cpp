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
#include "surface/motion/material.h"
#include "surface/motion/regional.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/origin_map.h"

namespace kappaflow {
namespace {

constexpr double kShareOfFast = 0.999;  // a few that fly off do not set the number of steps
constexpr int kMostSteps = 1000000;     // from one instant to the next

/// What a surface moves with, as far as particles tell, where no method says it.
VelocityFunction default_velocity(const SurfaceOptions& options) {
  return options.is_cloud ? evaluate_regional : evaluate_material;
}

std::vector<SurfaceMethod> methods_of(const SurfaceOptions& options) {
  if (!options.velocities.empty()) return options.velocities;
  return {default_velocity(options)};
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
    : TrackedSurfaces(std::move(first), nullptr, options) {}

TrackedSurfaces::TrackedSurfaces(Particles first, const Particles& next, const SurfaceOptions& options)
    : TrackedSurfaces(std::move(first), &next, options) {}

TrackedSurfaces::TrackedSurfaces(Particles first, const Particles* next, const SurfaceOptions& options)
    : particles_(std::move(first)),
      field_options_(kappaflow::field_options(options, particles_.position, particles_.scale)),
      is_cloud_(options.is_cloud),
      motion_per_step_(options.motion_per_step),
      name_(options.name),
      field_(next ? motion_to(*next).at(particles_.time) : particle_field(particles_, field_options_)),
      report_(methods_of(options).size()),
      surfaces_(make_surfaces(*field_, field_options_.sigma, options, report_[0])),
      from_particles_(kappaflow::from_particles(options)),
      first_mesh_seconds_(report_[0].topology_seconds + report_[0].remesh_seconds) {
  if (std::ranges::count(from_particles_, 1) == 0) return;
  if (is_cloud_)
    throw InvalidInput(fmt::format("{}: textures from particles take particles with ids", name_));
  origins_.emplace().see(particles_);
}

/// first_mesh: what making it took.
std::vector<TrackedSurfaces::Surface> TrackedSurfaces::make_surfaces(const Field& field, double sigma,
                                                                     const SurfaceOptions& surface,
                                                                     TrackerStep& first_mesh) {
  const double edge_length = surface.edge_length * sigma;
  TriangleMesh mesh;
  const double seconds =
      seconds_of([&] { mesh = initial_mesh(field, edge_length, surface.tracker.projection); });
  if (mesh.triangles.empty())
    throw InvalidInput(
        fmt::format("{}: the surface is empty: Eq. 12 stays below the threshold everywhere", surface.name));
  TrackerOptions options = surface.tracker;
  options.remeshing.edge_length = surface.remesh ? edge_length : 0;
  options.topology.follows_field = surface.topology;
  TrackerStep settling;
  mesh = SurfaceTracker::settled(field, std::move(mesh), options, &settling);
  first_mesh.topology_seconds = settling.topology_seconds;
  first_mesh.remesh_seconds = seconds + settling.remesh_seconds;
  std::vector<Surface> surfaces;
  for (const SurfaceMethod& method : methods_of(surface)) {
    if (const auto* velocity = std::get_if<VelocityFunction>(&method)) {
      options.method = *velocity;
      surfaces.emplace_back(SurfaceTracker(mesh, options));
    } else {
      const bool has_grid = std::get<FreshMesh>(method) == FreshMesh::grid;
      if (has_grid && surface.is_cloud)
        throw InvalidInput(
            fmt::format("{}: textures on a grid take particles with velocities", surface.name));
      surfaces.emplace_back(
          FreshSurface(mesh, edge_length, default_velocity(surface), options.velocity,
                       has_grid ? std::optional(RestGrid(field, edge_length)) : std::nullopt));
    }
  }
  return surfaces;
}

/// Particles without velocities say nothing about how fast their surface may be: it is what the motion of a
/// cloud allows.
double TrackedSurfaces::cloud_speed_to(const Particles& next) const {
  return is_cloud_ ? kLargestCloudMotion * field_options_.sigma / (next.time - particles_.time) : 0;
}

ParticleMotion TrackedSurfaces::motion_to(const Particles& next) const {
  ParticleFieldOptions options = field_options_;
  options.cloud_speed = cloud_speed_to(next);
  return {particles_, next, options};
}

int TrackedSurfaces::steps_to(const Particles& next) const {
  if (motion_per_step_ == kInfinity) return 1;
  const double speed = std::max({fast_speed(particles_), fast_speed(next), cloud_speed_to(next)});
  const double steps = speed * (next.time - particles_.time) / (motion_per_step_ * field_options_.sigma);
  if (!(steps <= kMostSteps))
    throw InvalidInput(
        fmt::format("{}: particles at {:.3g} m/s move {:.3g} sigma from the instant {:.6g} s to the next; at "
                    "most {:.3g} are allowed",
                    name_, speed, steps * motion_per_step_, particles_.time, kMostSteps * motion_per_step_));
  return whole_within(std::ceil(steps), 1, kMostSteps);
}

bool TrackedSurfaces::step(Particles next, const Watch& watch) {
  ParticleMotion motion = motion_to(next);
  const int steps = steps_to(next);
  const double t0 = motion.t0(), dt = (motion.t1() - t0) / steps;
  double time = t0;
  for (int s = 1; s <= steps; ++s) {
    const double end = s == steps ? motion.t1() : t0 + s * dt;
    MotionPart part(motion, time, end);
    step_surfaces(part);
    if (watch && !watch(part) && s < steps) return false;
    motion.forget_before(end);
    time = end;
  }
  particles_ = std::move(next);
  if (origins_) origins_->see(particles_);
  return true;
}

void TrackedSurfaces::step_surfaces(FieldMotion& motion) {
  for (std::size_t m = 0; m < surfaces_.size(); ++m)
    report_[m] += std::visit([&](auto& surface) { return surface.step(motion); }, surfaces_[m]);
  field_ = motion.at(motion.t1());
}

void TrackedSurfaces::settle(std::span<const int> source, bool anew) {
  for (std::size_t m = 0; m < surfaces_.size(); ++m)
    report_[m] += std::visit([&](auto& surface) { return surface.settle(*field_); }, surfaces_[m]);
  find_sources(source, anew);
}

void TrackedSurfaces::advance(Particles next, std::span<const int> source) {
  step(std::move(next));
  settle(source);
}

TriangleMesh& TrackedSurfaces::mesh_of(Surface& surface) {
  return std::visit([](auto& followed) -> TriangleMesh& { return followed.mesh(); }, surface);
}

const TriangleMesh& TrackedSurfaces::mesh(std::size_t surface) const {
  return std::visit([](const auto& followed) -> const TriangleMesh& { return followed.mesh(); },
                    surfaces_[surface]);
}

SurfaceState TrackedSurfaces::state(std::size_t surface) const {
  return std::visit([&](const auto& followed) { return followed.state(*field_); }, surfaces_[surface]);
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

std::vector<TrackerStep> TrackedSurfaces::take_report() {
  return std::exchange(report_, std::vector<TrackerStep>(surfaces_.size()));
}

}  // namespace kappaflow
