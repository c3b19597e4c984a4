#include "surface/tracker/surface_tracker.h"

#include <algorithm>
#include <optional>

#include "core/errors.h"
#include "core/stopwatch.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/tracker/mobility.h"

namespace kappaflow {
namespace {

constexpr int kSettlingRounds = 4;

}  // namespace

SurfaceTracker::SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options)
    : options_(options), mesh_(std::move(initial_mesh)) {
  if (!options.method) throw InvalidInput("a surface cannot be tracked without a velocity method");
  start_from_mesh();
}

void SurfaceTracker::start_from_mesh() {
  vertex_rings(mesh_.vertex_count(), mesh_.triangles, rings_);
  fairing_ = fairing_state(mesh_, rings_);
  area_.resize(mesh_.vertex_count());
}

TrackerStep SurfaceTracker::step(FieldMotion& motion) {
  TrackerStep report;
  report.velocity_seconds = seconds_of([&] { advect(motion); });
  const std::shared_ptr<const Field> field = motion.at(motion.t1());
  report.fairing_seconds = seconds_of([&] {
    report.residual_max = project(*field);
    const double residual = fair(*field, rings_, options_.fairing, options_.projection,
                                 motion.t1() - motion.t0(), mesh_, fairing_);
    if (options_.fairing.iterations > 0) report.residual_max = residual;
  });
  --steps_to_lattice_;
  if (++steps_unmended_ >= options_.mending_interval) mend(*field, report);
  finish(report);
  return report;
}

/// Changes of topology go first: what the isosurface puts in is the remesher's to refine.
void SurfaceTracker::mend(const Field& field, TrackerStep& report) {
  steps_unmended_ = 0;
  if (!(options_.remeshing.edge_length > 0)) return;
  if (options_.topology.follows_field) {
    const bool compare_all = steps_to_lattice_ <= 0;
    if (compare_all) steps_to_lattice_ = options_.topology.lattice_interval;
    change_topology(field, compare_all ? Comparison::thorough : Comparison::quick, report);
  }
  remesh(field, report);
}

TrackerStep SurfaceTracker::settle(const Field& field) {
  TrackerStep report;
  if (options_.remeshing.edge_length > 0) {
    remesh(field, report);
    Comparison comparison = Comparison::thorough;
    for (int round = 0; options_.topology.follows_field && change_topology(field, comparison, report) &&
                        round < kSettlingRounds;
         ++round) {
      remesh(field, report);
      comparison = Comparison::repeated;
    }
    steps_to_lattice_ = options_.topology.lattice_interval;
    steps_unmended_ = 0;
  }
  finish(report);
  return report;
}

TriangleMesh SurfaceTracker::settled(const Field& field, TriangleMesh mesh, const TrackerOptions& options) {
  SurfaceTracker tracker(std::move(mesh), options);
  TriangleMesh& moved = tracker.mesh_;
  project_all(field, options.projection, moved.position, moved.unprojected, moved.gradient);
  tracker.settle(field);
  TriangleMesh at_rest = make_triangle_mesh(std::move(moved.position), std::move(moved.triangles));
  at_rest.unprojected = std::move(moved.unprojected);
  return at_rest;
}

void SurfaceTracker::finish(TrackerStep& report) const {
  report.residual_max = std::max(report.residual_max, report.edits.residual_max);
  report.unprojected = static_cast<std::size_t>(std::ranges::count(mesh_.unprojected, 1));
}

/// Puts all vertices on the surface and finds out which ones fairing may move.
double SurfaceTracker::project(const Field& field) {
  if (options_.fairing.iterations > 0 && options_.fairing.moves == FairedVertices::undetermined)
    vertex_mobility(rings_, velocities_, mesh_.mobility);
  return project_all(field, options_.projection, mesh_.position, mesh_.unprojected, mesh_.gradient);
}

/// Returns whether something was replaced.
bool SurfaceTracker::change_topology(const Field& field, Comparison comparison, TrackerStep& report) {
  TopologyCounts counts;
  report.topology_seconds += seconds_of([&] {
    counts = topology_change_.change(field, options_.topology, options_.remeshing.edge_length,
                                     options_.projection, comparison, mesh_);
    if (counts.replaced > 0) renew_connectivity(topology_change_.history());
  });
  report.topology += counts;
  return counts.replaced > 0;
}

void SurfaceTracker::remesh(const Field& field, TrackerStep& report) {
  std::optional<LatticeGuard> guard;
  if (options_.topology.follows_field)
    guard.emplace(topology_guard(field, options_.topology, options_.remeshing.edge_length));
  report.remesh_seconds += seconds_of([&] {
    const RemeshCounts counts = remesher_.remesh(field, options_.remeshing, options_.projection, rings_,
                                                 mesh_, guard ? &*guard : nullptr);
    if (counts.any()) renew_connectivity(remesher_.history());
    report.edits += counts;
  });
}

/// Brings all that depends on the connectivity up to date.
void SurfaceTracker::renew_connectivity(const VertexHistory& history) {
  std::swap(rings_, rings_before_);
  vertex_rings(mesh_.vertex_count(), mesh_.triangles, rings_);
  renew_fairing_state(mesh_, history, rings_before_, rings_, fairing_);
  area_.resize(mesh_.vertex_count());
}

void SurfaceTracker::advect(FieldMotion& motion) {
  vertex_areas(mesh_.position, mesh_.triangles, area_);
  runge_kutta_.advance(motion, options_.integrator, mesh_.position,
                       [&](const Field& field, std::span<const Vec3> position) -> std::span<const Vec3> {
                         options_.method(field, {position, area_, rings_}, options_.velocity, velocities_);
                         return velocities_.velocity;
                       });
}

}  // namespace kappaflow
