// The tracked mesh: vertices with their attributes, and triangles.
#pragma once

#include <span>
#include <vector>

#include "surface/mesh/vertex_rings.h"

namespace kappaflow {

/// An oriented triangle mesh, counter-clockwise seen from outside. Vertex arrays have one entry a vertex.
struct TriangleMesh {
  std::vector<Vec3> position;       ///< [m]
  std::vector<Vec3> rest_position;  ///< position in the initial mesh [m]: a seamless 3D texture coordinate
  std::vector<char> unprojected;    ///< 1 where the last projection on f = 0 failed
  std::vector<Triangle> triangles;

  std::size_t vertex_count() const { return position.size(); }
};

/// A mesh at rest: rest_position = position, all vertices projected.
TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles);

}  // namespace kappaflow
