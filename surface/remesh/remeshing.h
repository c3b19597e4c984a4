// Keeps the triangles of a tracked mesh in good order while the surface stretches, folds and bends.
#pragma once

#include <memory>

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/mesh/mesh_edits.h"

namespace kappaflow {

/// The edge length aimed at is clamp(turn / kappa, finest edge_length, edge_length), kappa the largest normal
/// curvature of the surface.
struct RemeshOptions {
  double edge_length = 0;  ///< where the surface is flat [m]; 0: the mesh keeps its connectivity
  double turn = 0.5;       ///< angle by which the normal turns along an edge of the length aimed at [rad]
  double finest = 0.5;     ///< smallest edge length, as a share of edge_length, (0, 1]
};

/// What one remeshing did.
struct RemeshCounts {
  std::size_t splits = 0, collapses = 0, flips = 0;
  std::size_t replaced = 0;  ///< vertices that a new one at a better place stands for
  double residual_max = 0;   ///< Projected::residual of the new vertices

  bool any() const { return splits + collapses + flips + replaced > 0; }
  RemeshCounts& operator+=(const RemeshCounts& other) {
    splits += other.splits;
    collapses += other.collapses;
    flips += other.flips;
    replaced += other.replaced;
    residual_max = residual_max > other.residual_max ? residual_max : other.residual_max;
    return *this;
  }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(splits, collapses, flips, replaced, residual_max);
  }
};

struct RemeshState;

/// Remeshing after Botsch & Kobbelt, "A remeshing approach to multiresolution modeling" (2004), in the form
/// that keeps a vertex where its material is: edges that are 1.5 times as long as aimed at are split in the
/// middle and the new vertex put on f = 0; so are triangles, or their longest edges, that are further from
/// f = 0 than 0.15 edge_length; of edges shorter than 0.6 times that, one end goes and the other
/// stays as it is; edges flip towards Delaunay; and triangles with an angle below 22 degrees (hence all with
/// one above 136) lose their shortest edge or, where that cannot be, one corner to a new vertex at a better
/// place. No vertex is moved: those that stay keep id, position and arrays, those that come have new ids and
/// entries by the arrays' rules from where they are put.
///
/// No edit turns a triangle by more than 72 degrees, takes one that far off f = 0, leaves one that faces less
/// along the field's normals at its corners than the worst before and cos 25 degrees, or is refused by the
/// guard; but one that removes an angle below 15 degrees, or a rim cut off, may turn more and face less if it
/// crosses no triangle around. The order of edits depends on lengths and, where these are equal, on vertex
/// numbers: results do not depend on the threads.
class Remesher {
 public:
  Remesher();
  ~Remesher();
  Remesher(Remesher&&) noexcept;
  Remesher& operator=(Remesher&&) noexcept;

  /// mesh: closed and oriented, its vertices projected, TriangleMesh::gradient theirs. rings: of the mesh as
  /// it is; they are to be renewed (see history()) if RemeshCounts::any(). guard: see MeshEdits; null: none.
  /// Throws TopologyError for a mesh that is not closed, with no change.
  RemeshCounts remesh(const Field& field, const RemeshOptions& options, const ProjectionOptions& projection,
                      const VertexRings& rings, TriangleMesh& mesh, const EditGuard* guard = nullptr);

  /// What became of the vertices in the last remesh().
  const VertexHistory& history() const;

 private:
  std::unique_ptr<RemeshState> state_;
};

}  // namespace kappaflow
