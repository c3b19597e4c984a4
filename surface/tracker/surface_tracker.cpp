#include "surface/tracker/surface_tracker.h"

#include <algorithm>
#include <optional>

#include "core/errors.h"
#include "core/saved_state.h"
#include "core/stopwatch.h"
#include "surface/field/runge_kutta.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/remeshing.h"
#include "surface/topology/topology.h"
#include "surface/tracker/fairing.h"
#include "surface/tracker/mobility.h"

namespace kappaflow {
namespace {

constexpr int kSettlingRounds = 4;  // of replacing and remeshing: one may call for another nearby

/// VertexHistory::touched of edits and others that came after them.
std::vector<char> touched_by_both(const VertexHistory& first, const VertexHistory& second) {
  std::vector<char> touched = second.touched;
  for (int v = 0; v < static_cast<int>(touched.size()); ++v)
    if (const int before = second.before(v); before >= 0) touched[v] |= first.touched[before];
  return touched;
}

}  // namespace

/// Everything that a tracker keeps between its steps, and their parts.
struct SurfaceTracker::State {
  State(TriangleMesh initial_mesh, const TrackerOptions& tracker_options)
      : options(tracker_options), mesh(std::move(initial_mesh)) {
    start_from_mesh();
  }

  void start_from_mesh();
  void advect(FieldMotion& motion);
  double project(const Field& field);
  void repair(const Field& field, TrackerStep& report);
  bool change_topology(const Field& field, Comparison comparison, TrackerStep& report);
  void finish(TrackerStep& report) const;
  void remesh(const Field& field, TrackerStep& report);
  void renew_connectivity(const VertexHistory& history);

  template <class Archive>
  void serialize(Archive& archive) {
    archive(mesh);
    if constexpr (Archive::is_loading::value) start_from_mesh();
    archive(fairing, steps_to_lattice, steps_unrepaired);
  }

  TrackerOptions options;
  TriangleMesh mesh;
  VertexRings rings, rings_before;
  FairingState fairing;
  RungeKutta runge_kutta;
  TopologyChange topology_change;
  int steps_to_lattice = 1;  // until mesh and surface are compared on the whole lattice
  int steps_unrepaired = 0;  // since edits and changes of topology
  Remesher remesher;
  SurfaceVelocities velocities;  // of the last stage of the step
  std::vector<double> area;      // at the start of the step
};

SurfaceTracker::SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options) {
  if (!options.method) throw InvalidInput("a surface cannot be tracked without a velocity method");
  state_ = std::make_unique<State>(std::move(initial_mesh), options);
}
SurfaceTracker::~SurfaceTracker() = default;
SurfaceTracker::SurfaceTracker(SurfaceTracker&&) noexcept = default;
SurfaceTracker& SurfaceTracker::operator=(SurfaceTracker&&) noexcept = default;

const TriangleMesh& SurfaceTracker::mesh() const {
  return state_->mesh;
}
TriangleMesh& SurfaceTracker::mesh() {
  return state_->mesh;
}
const VertexRings& SurfaceTracker::rings() const {
  return state_->rings;
}
const TrackerOptions& SurfaceTracker::options() const {
  return state_->options;
}
SurfaceState SurfaceTracker::state(const Field& field) const {
  return surface_state(field, mesh(), rings(), options().method, options().velocity);
}

template <class Archive>
void SurfaceTracker::serialize(Archive& archive) {
  state_->serialize(archive);
}
template void SurfaceTracker::serialize(StateWriter&);
template void SurfaceTracker::serialize(StateReader&);

void SurfaceTracker::State::start_from_mesh() {
  vertex_rings(mesh.vertex_count(), mesh.triangles, rings);
  fairing = fairing_state(mesh, rings);
  area.resize(mesh.vertex_count());
}

TrackerStep SurfaceTracker::step(FieldMotion& motion) {
  State& s = *state_;
  TrackerStep report;
  report.velocity_seconds = seconds_of([&] { s.advect(motion); });
  const std::shared_ptr<const Field> field = motion.at(motion.t1());
  report.fairing_seconds = seconds_of([&] {
    report.residual_max = s.project(*field);
    const double residual = fair(*field, s.rings, s.options.fairing, s.options.projection,
                                 motion.t1() - motion.t0(), s.mesh, s.fairing);
    report.residual_max = std::max(report.residual_max, residual);
  });
  --s.steps_to_lattice;
  if (++s.steps_unrepaired >= s.options.repair_interval) s.repair(*field, report);
  s.finish(report);
  return report;
}

/// Changes of topology go first: what the isosurface puts in is the remesher's to refine.
void SurfaceTracker::State::repair(const Field& field, TrackerStep& report) {
  steps_unrepaired = 0;
  if (!(options.remeshing.edge_length > 0)) return;
  if (options.topology.follows_field) {
    const bool compare_all = steps_to_lattice <= 0;
    if (compare_all) steps_to_lattice = options.topology.lattice_interval;
    change_topology(field, compare_all ? Comparison::thorough : Comparison::quick, report);
  }
  remesh(field, report);
}

TrackerStep SurfaceTracker::settle(const Field& field) {
  State& s = *state_;
  TrackerStep report;
  if (s.options.remeshing.edge_length > 0) {
    s.remesh(field, report);
    Comparison comparison = Comparison::thorough;
    for (int round = 0; s.options.topology.follows_field && round < kSettlingRounds &&
                        s.change_topology(field, comparison, report);
         ++round) {
      s.remesh(field, report);
      comparison = Comparison::repeated;
    }
    s.steps_to_lattice = s.options.topology.lattice_interval;
    s.steps_unrepaired = 0;
  }
  s.finish(report);
  return report;
}

TriangleMesh SurfaceTracker::settled(const Field& field, TriangleMesh mesh, const TrackerOptions& options,
                                     TrackerStep* report) {
  SurfaceTracker tracker(std::move(mesh), options);
  TriangleMesh& moved = tracker.state_->mesh;
  project_all(field, options.projection, moved.position, moved.unprojected, moved.gradient);
  const TrackerStep settling = tracker.settle(field);
  if (report != nullptr) *report = settling;
  TriangleMesh at_rest = make_triangle_mesh(std::move(moved.position), std::move(moved.triangles));
  at_rest.unprojected = std::move(moved.unprojected);
  return at_rest;
}

void SurfaceTracker::State::finish(TrackerStep& report) const {
  report.residual_max = std::max(report.residual_max, report.edits.residual_max);
  report.unprojected = static_cast<std::size_t>(std::ranges::count(mesh.unprojected, 1));
}

/// Puts all vertices on the surface and finds out which ones fairing may move.
double SurfaceTracker::State::project(const Field& field) {
  if (options.fairing.iterations > 0 && options.fairing.moves == FairedVertices::undetermined)
    vertex_mobility(rings, velocities, mesh.mobility);
  return project_all(field, options.projection, mesh.position, mesh.unprojected, mesh.gradient);
}

/// Returns whether something was replaced.
bool SurfaceTracker::State::change_topology(const Field& field, Comparison comparison, TrackerStep& report) {
  TopologyCounts counts;
  report.topology_seconds += seconds_of([&] {
    const std::vector<char> touched = comparison == Comparison::repeated
                                          ? touched_by_both(topology_change.history(), remesher.history())
                                          : std::vector<char>();
    counts = topology_change.change(field, options.topology, options.remeshing.edge_length,
                                    options.projection, comparison, mesh, touched);
    if (counts.replaced > 0) renew_connectivity(topology_change.history());
  });
  report.topology += counts;
  return counts.replaced > 0;
}

void SurfaceTracker::State::remesh(const Field& field, TrackerStep& report) {
  std::optional<LatticeGuard> guard;
  if (options.topology.follows_field)
    guard.emplace(topology_guard(field, options.topology, options.remeshing.edge_length));
  report.remesh_seconds += seconds_of([&] {
    const RemeshCounts counts =
        remesher.remesh(field, options.remeshing, options.projection, rings, mesh, guard ? &*guard : nullptr);
    if (counts.any()) renew_connectivity(remesher.history());
    report.edits += counts;
  });
}

/// Brings all that depends on the connectivity up to date.
void SurfaceTracker::State::renew_connectivity(const VertexHistory& history) {
  std::swap(rings, rings_before);
  vertex_rings(mesh.vertex_count(), mesh.triangles, rings);
  renew_fairing_state(mesh, history, rings_before, rings, fairing);
  area.resize(mesh.vertex_count());
}

void SurfaceTracker::State::advect(FieldMotion& motion) {
  vertex_areas(mesh.position, mesh.triangles, area);
  runge_kutta.advance(
      motion, options.integrator, mesh.position,
      [&](const Field& field, std::span<const Vec3> position) -> std::span<const Vec3> {
        options.method(field, {position, area, rings}, options.velocity, velocities.sized(position.size()));
        return velocities.velocity;
      });
}

}  // namespace kappaflow
