// Small closed meshes, and whether a mesh is closed at each vertex.
#pragma once

#include <map>
#include <vector>

#include "surface/mesh/triangle_mesh.h"

namespace kappaflow::testing {

/// Whether the triangles of every vertex form one closed fan.
inline bool has_single_fans(const TriangleMesh& mesh) {
  std::vector<std::map<int, int>> next(mesh.vertex_count());
  for (const Triangle& t : mesh.triangles)
    for (int corner = 0; corner < 3; ++corner) next[t[corner]][t[(corner + 1) % 3]] = t[(corner + 2) % 3];
  for (const std::map<int, int>& fan : next) {
    if (fan.empty()) return false;
    std::size_t steps = 0;
    int v = fan.begin()->first;
    do {
      const auto it = fan.find(v);
      if (it == fan.end()) return false;
      v = it->second;
    } while (++steps <= fan.size() && v != fan.begin()->first);
    if (steps != fan.size()) return false;
  }
  return true;
}

/// A closed oriented mesh of `count` tetrahedra that share nothing.
inline TriangleMesh tetrahedra(int count) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 at(3.0 * i, 0, 0);
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)})
      mesh.position.push_back(at + corner);
    for (const Triangle& t : {Triangle{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
      mesh.triangles.push_back({t[0] + 4 * i, t[1] + 4 * i, t[2] + 4 * i});
  }
  return make_triangle_mesh(mesh.position, mesh.triangles);
}

}  // namespace kappaflow::testing
