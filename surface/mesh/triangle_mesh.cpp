#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  mesh.rest_position = position;
  mesh.unprojected.assign(position.size(), 0);
  mesh.position = std::move(position);
  mesh.triangles = std::move(triangles);
  return mesh;
}

}  // namespace kappaflow
