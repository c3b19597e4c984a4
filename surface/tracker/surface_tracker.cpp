#include "surface/tracker/surface_tracker.h"

#include <algorithm>

#include "core/stopwatch.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/tracker/mobility.h"

namespace kappaflow {

SurfaceTracker::SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options)
    : options_(options),
      method_(velocity_method(options.method)),
      mesh_(std::move(initial_mesh)),
      rings_(vertex_rings(mesh_.vertex_count(), mesh_.triangles)),
      fairing_(fairing_state(mesh_, rings_)),
      area_(mesh_.vertex_count()) {}

TrackerStep SurfaceTracker::step(FieldMotion& motion) {
  TrackerStep report;
  report.velocity_seconds = seconds_of([&] { advect(motion); });
  report.fairing_seconds = seconds_of([&] {
    if (options_.fairing.iterations > 0 && options_.fairing.moves == FairedVertices::undetermined)
      vertex_mobility(rings_, velocities_, fairing_.mobility);
    report.residual_max = fair(*motion.at(motion.t1()), rings_, options_.fairing, options_.projection,
                               motion.t1() - motion.t0(), mesh_, fairing_);
  });
  report.unprojected = static_cast<std::size_t>(std::ranges::count(mesh_.unprojected, 1));
  return report;
}

void SurfaceTracker::advect(FieldMotion& motion) {
  vertex_areas(mesh_.position, mesh_.triangles, area_);
  runge_kutta_.advance(motion, options_.integrator, mesh_.position,
                       [&](const Field& field, std::span<const Vec3> position) -> std::span<const Vec3> {
                         method_.evaluate(field, {position, area_, rings_}, options_.velocity, velocities_);
                         return velocities_.velocity;
                       });
}

}  // namespace kappaflow
