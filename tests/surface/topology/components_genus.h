// The topology of a mesh as a pair that tests compare.
#pragma once

#include <utility>

#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow::testing {

/// Components and genus.
using ComponentsGenus = std::pair<int, int>;

inline ComponentsGenus topology_of(const TriangleMesh& mesh) {
  const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles);
  return {topology.components, topology.genus};
}

}  // namespace kappaflow::testing
