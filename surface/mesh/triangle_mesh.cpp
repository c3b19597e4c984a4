#include "surface/mesh/triangle_mesh.h"

#include <algorithm>
#include <numeric>

namespace kappaflow {

TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  mesh.rest_position = position;
  mesh.source.assign(position.size(), kUnknownSource);
  mesh.unprojected.assign(position.size(), 0);
  mesh.id.resize(position.size());
  std::iota(mesh.id.begin(), mesh.id.end(), std::int64_t{0});
  mesh.next_id = static_cast<std::int64_t>(position.size());
  mesh.position = std::move(position);
  mesh.triangles = std::move(triangles);
  return mesh;
}

std::size_t vertices_older_than(const TriangleMesh& mesh, std::int64_t id) {
  return static_cast<std::size_t>(std::ranges::lower_bound(mesh.id, id) - mesh.id.begin());
}

void remove_dead(std::span<const char> alive, TriangleMesh& mesh, VertexHistory& history) {
  history.number.clear();
  std::vector<int> renumbered(alive.size());
  for (std::size_t v = 0; v < alive.size(); ++v) {
    renumbered[v] = static_cast<int>(history.number.size());
    if (alive[v]) history.number.push_back(static_cast<int>(v));
  }
  history.keep(mesh.position);
  history.keep(mesh.rest_position);
  history.keep(mesh.source);
  history.keep(mesh.unprojected);
  history.keep(mesh.id);
  std::erase(mesh.triangles, kRemovedTriangle);
  for (Triangle& triangle : mesh.triangles)
    for (int& v : triangle) v = renumbered[v];
}

}  // namespace kappaflow
