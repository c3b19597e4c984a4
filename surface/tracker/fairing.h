// Fairing of section 3.4: a spring-mass relaxation in the tangent planes that evens out the triangles.
#pragma once

#include <vector>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/tracker/projection.h"

namespace kappaflow {

struct FairingOptions {
  int iterations = 10;                 ///< relaxations a step; 0 switches fairing off
  double relaxation = 0.5;             ///< share of the way to the springs' equilibrium that an iteration goes, in (0, 1]
  double rest_length_time = 0.5;       ///< rest lengths follow the current lengths with this time constant [s]
};

/// Rest lengths of the springs, parallel to VertexRings::neighbour [m].
struct FairingState {
  std::vector<double> rest_length;
};

/// Rest lengths = the current edge lengths.
FairingState fairing_state(const TriangleMesh& mesh, const VertexRings& rings);

/// Runs the iterations: every vertex moves from the same old state (Jacobi), so the order does not matter; after each
/// iteration all vertices are projected on f = 0 by Eq. 11. Then the rest lengths relax over dt [s].
/// Returns the largest residual of the last projection (see project_all).
double fair(const Field& field, const VertexRings& rings, const FairingOptions& options,
            const ProjectionOptions& projection, double dt, TriangleMesh& mesh, FairingState& state);

}  // namespace kappaflow
