#include "tools/runs/tracked_surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/errors.h"
#include "core/nearest_points.h"
#include "surface/remesh/initial_mesh.h"

namespace kappaflow {
namespace {

std::vector<SurfaceTracker> make_trackers(const Field& field, double sigma,
                                          const SurfaceDescription& description, const std::string& source) {
  const double edge_length = description.edge_length * sigma;
  TriangleMesh mesh = initial_mesh(field, edge_length, description.tracker.projection);
  if (mesh.triangles.empty())
    throw InvalidInput(
        fmt::format("{}: the surface is empty: Eq. 12 stays below the threshold everywhere", source));
  TrackerOptions options = description.tracker;
  options.remeshing.edge_length = description.remesh ? edge_length : 0;
  options.topology.follows_field = description.topology;
  mesh = SurfaceTracker::settled(field, std::move(mesh), options);
  std::vector<SurfaceTracker> trackers;
  trackers.reserve(description.methods.size());
  for (const std::string& method : description.methods) {
    options.method = method;
    trackers.emplace_back(mesh, options);
  }
  return trackers;
}

}  // namespace

ParticleFieldOptions field_options(const SurfaceDescription& description, double spacing,
                                   std::span<const Vec3> liquid) {
  ParticleFieldOptions options;
  options.sigma = description.sigma * spacing;
  options.weights = description.weights;
  options.threshold = description.threshold.value_or(0);
  if (!description.threshold) {
    const std::vector<double> weights = field_weights(liquid, options.sigma, options.weights);
    options.threshold = half_median_threshold(liquid, weights, options.sigma);
  }
  return options;
}

TrackedSurfaces::TrackedSurfaces(std::shared_ptr<const Field> field, const ParticleFieldOptions& options,
                                 const SurfaceDescription& description, const std::string& source)
    : options_(options),
      field_(std::move(field)),
      trackers_(make_trackers(*field_, options.sigma, description, source)),
      tracers_(trackers_.front().mesh().position) {
  take_since_frame();
}

void TrackedSurfaces::step(FieldMotion& motion) {
  for (std::size_t m = 0; m < trackers_.size(); ++m) add_to_frame(m, trackers_[m].step(motion));
  const Stopwatch watch;
  tracers_.step(motion);
  since_frame_.tracer_seconds += watch.seconds();
  field_ = motion.at(motion.t1());
}

void TrackedSurfaces::settle() {
  for (std::size_t m = 0; m < trackers_.size(); ++m) add_to_frame(m, trackers_[m].settle(*field_));
}

void TrackedSurfaces::add_to_frame(std::size_t method, const TrackerStep& step) {
  since_frame_.residual_max[method] = std::max(since_frame_.residual_max[method], step.residual_max);
  since_frame_.seconds[method].velocity += step.velocity_seconds;
  since_frame_.seconds[method].fairing += step.fairing_seconds;
  since_frame_.seconds[method].topology += step.topology_seconds;
  since_frame_.seconds[method].remesh += step.remesh_seconds;
  since_frame_.topology[method] += step.topology;
}

SurfacesSinceFrame TrackedSurfaces::take_since_frame() {
  SurfacesSinceFrame fresh;
  fresh.residual_max.assign(trackers_.size(), 0);
  fresh.topology.assign(trackers_.size(), {});
  fresh.seconds.assign(trackers_.size(), {});
  return std::exchange(since_frame_, std::move(fresh));
}

void TrackedSurfaces::find_sources(std::span<const Vec3> position, std::span<const int> source) {
  if (source.empty()) return;
  for (SurfaceTracker& tracker : trackers_) {
    const std::span<int> of_vertex = tracker.source();
    std::vector<std::size_t> unknown;
    std::vector<Vec3> place;
    for (std::size_t v = 0; v < of_vertex.size(); ++v) {
      if (of_vertex[v] != kUnknownSource) continue;
      unknown.push_back(v);
      place.push_back(tracker.mesh().position[v]);
    }
    if (unknown.empty()) continue;
    const std::vector<std::uint32_t> nearest = nearest_points(position, place);
    for (std::size_t k = 0; k < unknown.size(); ++k) of_vertex[unknown[k]] = source[nearest[k]];
  }
}

}  // namespace kappaflow
