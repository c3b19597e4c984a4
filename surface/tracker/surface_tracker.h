// Carries one explicit mesh along with a moving implicit surface.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "surface/field/field.h"
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
  /// TriangleMesh::source, for whoever knows the liquid to fill in.
  std::span<int> source();
  /// TriangleMesh::add_array() of the mesh, and the entries of the array, to be filled in.
  template <class T>
  std::span<T> add_array(std::string_view name, Carry carry, const T& fresh) {
    return own_mesh().add_array(name, carry, fresh);
  }
  template <class T>
  std::span<T> array(std::string_view name) {
    return own_mesh().template array<T>(name);
  }
  const VertexRings& rings() const;
  const TrackerOptions& options() const;

  /// See core/saved_state.h; for a tracker that was made with the same options, on any mesh.
  template <class Archive>
  void serialize(Archive& archive);

 private:
  TriangleMesh& own_mesh();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kappaflow
