// How smooth the map from the tracked mesh to the first one is: what a texture shows.
#pragma once

#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Jumps of the gradient of rest_position across the edges of a mesh, relative to the gradient itself.
struct TextureJumps {
  double mean = 0;    ///< over the edges [1]
  double cracks = 0;  ///< share of the edges with a jump above 1: a fold, a tear or a smear of the texture
};

/// In each triangle rest_position is a linear function of the place, X = F x. Along the edge that two
/// triangles share, F is the same for both; across it, with unit vectors d in the planes of the triangles,
/// orthogonal to the edge and both pointing from the first to the second triangle, the jump is
/// 2 |F1 d1 - F2 d2| / (|F1 d1| + |F2 d2|). It is at most 2 and, for a smooth map, of the order of the mesh
/// width. Edges at triangles without area do not count. mesh: closed and oriented.
TextureJumps texture_jumps(const TriangleMesh& mesh);

}  // namespace kappaflow
