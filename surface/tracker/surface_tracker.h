// Carries one explicit mesh along with a moving implicit surface.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/field/runge_kutta.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/motion/regional.h"
#include "surface/motion/velocity.h"
#include "surface/remesh/remeshing.h"
#include "surface/topology/topology.h"
#include "surface/tracker/fairing.h"

namespace kappaflow {

struct TrackerOptions {
  VelocityFunction method = evaluate_regional;  ///< how fast the vertices are; see surface/motion
  TimeIntegrator integrator = TimeIntegrator::rk2;
  VelocityOptions velocity{};
  ProjectionOptions projection{};
  FairingOptions fairing{};
  RemeshOptions remeshing{};
  TopologyOptions topology{};  ///< takes effect where remeshing does
  /// Steps from one mending (change of topology and remeshing) to the next, >= 1. Two do where a step moves
  /// the liquid by a third of its particles' spacing at most.
  int mending_interval = 1;
};

/// What one step did, for metrics and timings.
struct TrackerStep {
  std::size_t unprojected = 0;  ///< vertices that are not on the surface after the step
  double residual_max =
      0;  ///< largest |f|/|g| over the projected vertices, in units of Field::length_scale()
  TopologyCounts topology;
  RemeshCounts edits;
  double velocity_seconds = 0;  ///< wall time of the advection
  double fairing_seconds = 0;   ///< wall time of fairing and projection
  double topology_seconds = 0;  ///< wall time of the changes of topology
  double remesh_seconds = 0;    ///< wall time of the edits

  /// Both one after the other.
  TrackerStep& operator+=(const TrackerStep& next) {
    unprojected = next.unprojected;
    residual_max = std::max(residual_max, next.residual_max);
    topology += next.topology;
    edits += next.edits;
    velocity_seconds += next.velocity_seconds;
    fairing_seconds += next.fairing_seconds;
    topology_seconds += next.topology_seconds;
    remesh_seconds += next.remesh_seconds;
    return *this;
  }

  /// See core/saved_state.h; without the wall times, which differ from run to run.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(unprojected, residual_max, topology, edits);
  }
};

/// Tracks a surface: its vertices move with the chosen velocity, and the mesh is kept in order by edits that
/// RemeshOptions describe and follows the surface's topology as TopologyOptions say. After a step every
/// vertex is within ProjectionOptions::tolerance of f = 0 or flagged in TriangleMesh::unprojected.
class SurfaceTracker {
 public:
  /// initial_mesh: on the surface f = 0 at the start of the first step. Throws InvalidInput where the method
  /// is an empty function.
  SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options);

  /// Moves the mesh from motion.t0() to motion.t1().
  TrackerStep step(FieldMotion& motion);

  /// Compares the mesh with f = 0 once more, on the whole lattice, and mends it until both agree or some
  /// rounds are over: what a frame shows has the surface's topology. field: at the end of the last step.
  TrackerStep settle(const Field& field);

  /// The mesh as a tracker with these options would show it after settle(), at rest: what to start from where
  /// the first frame is to be as good as the others.
  static TriangleMesh settled(const Field& field, TriangleMesh mesh, const TrackerOptions& options);

  const TriangleMesh& mesh() const { return mesh_; }
  /// TriangleMesh::source, for whoever knows the liquid to fill in.
  std::span<int> source() { return mesh_.source; }
  const VertexRings& rings() const { return rings_; }
  const VelocityFunction& method() const { return options_.method; }
  const TrackerOptions& options() const { return options_; }

  /// See core/saved_state.h; for a tracker that was made with the same options, on any mesh.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(mesh_);
    if constexpr (Archive::is_loading::value) start_from_mesh();
    archive(fairing_, steps_to_lattice_, steps_unmended_);
  }

 private:
  void start_from_mesh();
  void advect(FieldMotion& motion);
  double project(const Field& field);
  void mend(const Field& field, TrackerStep& report);
  bool change_topology(const Field& field, Comparison comparison, TrackerStep& report);
  void finish(TrackerStep& report) const;
  void remesh(const Field& field, TrackerStep& report);
  void renew_connectivity(const VertexHistory& history);

  TrackerOptions options_;
  TriangleMesh mesh_;
  VertexRings rings_, rings_before_;
  FairingState fairing_;
  RungeKutta runge_kutta_;
  TopologyChange topology_change_;
  int steps_to_lattice_ = 1;  // until mesh and surface are compared on the whole lattice
  int steps_unmended_ = 0;    // since edits and changes of topology
  Remesher remesher_;
  SurfaceVelocities velocities_;  // of the last stage of the step
  std::vector<double> area_;      // at the start of the step
};

}  // namespace kappaflow
