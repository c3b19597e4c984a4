// Fairing of section 3.4: a spring-mass relaxation in the tangent planes that evens out the triangles.
#pragma once

#include <vector>

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/mesh/vertex_history.h"
#include "surface/tracker/fairing_options.h"

namespace kappaflow {

/// Rest lengths of the springs, parallel to VertexRings::neighbour [m], and scratch that is kept between
/// steps.
struct FairingState {
  std::vector<double> rest_length;
  std::vector<int> third_corner;     ///< parallel to them: of the triangle that runs from vertex to neighbour
  std::vector<char> restless;        ///< whether a vertex has somewhere to go
  std::vector<int> moving;           ///< vertices that the step's iterations look at
  std::vector<Vec3> moved_position;  ///< parallel to them: where an iteration takes them, what is there
  std::vector<Vec3> moved_gradient;
  std::vector<char> moved_unprojected;
  std::vector<double> renewed;  ///< rest lengths in the making

  /// See core/saved_state.h; for the fairing_state() of the same mesh.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(rest_length);  // the rest follows from the next step
  }
};

/// Rest lengths = the current edge lengths. Precondition: a closed oriented mesh.
FairingState fairing_state(const TriangleMesh& mesh, const VertexRings& rings);

/// After edits of the mesh: edges that were there before keep their rest lengths, the others are born with
/// the lengths that they have. before, rings: of the mesh at the edits' start and now.
void renew_fairing_state(const TriangleMesh& mesh, const VertexHistory& history, const VertexRings& before,
                         const VertexRings& rings, FairingState& state);

/// Runs the iterations: every vertex moves from the same old state (Jacobi), so the order does not matter,
/// and all are projected on f = 0 by Eq. 11. Then the rest lengths relax over dt [s]. Precondition: the
/// vertices have been projected, and TriangleMesh::gradient is theirs.
///
/// A vertex goes a share `relaxation` times its mobility of one Newton step towards the equilibrium of its
/// springs, its neighbours fixed. A spring pulls with its length in space minus its rest length, along the
/// neighbour's direction in the tangent plane; so a mesh whose edges have their rest lengths stays as it is,
/// however curved it is. Two kinds of vertices go towards the centroid of their neighbours instead: those
/// whose projection failed, until it succeeds, and those of triangles that have folded over, which springs at
/// their rest lengths would keep folded; their mobility does not count. Vertices without mobility, which hold
/// their places, cost nothing, unless one beside them moves and could fold their triangles. Returns the
/// largest residual of what was projected last (see project_all), 0 where that is nothing.
double fair(const Field& field, const VertexRings& rings, const FairingOptions& options,
            const ProjectionOptions& projection, double dt, TriangleMesh& mesh, FairingState& state);

}  // namespace kappaflow
