// Keeps the triangles of a tracked mesh in good order while the surface stretches, folds and bends.
#pragma once

#include <memory>

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/mesh/mesh_edits.h"
#include "surface/remesh/remesh_options.h"

namespace kappaflow {

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
