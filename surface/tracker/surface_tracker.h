// Carries one explicit mesh along with a moving implicit surface.
#pragma once

#include <memory>

#include "surface/field/field.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/tracker/tracker_options.h"

namespace kappaflow {

/// Tracks a surface: its vertices move with the chosen velocity, and the mesh is kept in order by edits that
/// RemeshOptions describe and follows the surface's topology as TopologyOptions say. After a step every
/// vertex is within ProjectionOptions::tolerance of f = 0 or flagged in TriangleMesh::unprojected.
class SurfaceTracker {
 public:
  /// initial_mesh: on the surface f = 0 at the start of the first step. Throws InvalidInput where the method
  /// is an empty function.
  SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options);
  ~SurfaceTracker();
  SurfaceTracker(SurfaceTracker&&) noexcept;
  SurfaceTracker& operator=(SurfaceTracker&&) noexcept;

  /// Moves the mesh from motion.t0() to motion.t1(). After an exception of this or of settle() the tracker
  /// can only be destroyed or assigned to.
  TrackerStep step(FieldMotion& motion);

  /// Compares the mesh with f = 0 once more, on the whole lattice, and repairs it until both agree or some
  /// rounds are over: what a frame shows has the surface's topology. field: at the end of the last step.
  TrackerStep settle(const Field& field);

  /// The mesh as a tracker with these options would show it after settle(), at rest: what to start from where
  /// the first frame is to be as good as the others. report: what was done; null: nobody asks.
  static TriangleMesh settled(const Field& field, TriangleMesh mesh, const TrackerOptions& options,
                              TrackerStep* report = nullptr);

  const TriangleMesh& mesh() const;
  /// For whoever knows the liquid to fill in arrays; its vertices and triangles are the tracker's.
  TriangleMesh& mesh();
  const VertexRings& rings() const;
  const TrackerOptions& options() const;
  /// Normals, curvatures and velocities at the vertices. field: at the end of the last step.
  SurfaceState state(const Field& field) const;

  /// See core/saved_state.h; for a tracker that was made with the same options, on any mesh.
  template <class Archive>
  void serialize(Archive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kappaflow
