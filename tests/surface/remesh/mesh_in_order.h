// What must hold of a mesh that is remeshed as it goes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "surface/field/projection.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"

namespace kappaflow::testing {

inline std::vector<Vec3> normals(const Field& field, const TriangleMesh& mesh) {
  std::vector<Vec3> normal;
  for (const Vec3& x : mesh.position) normal.emplace_back(-field.value_and_gradient(x).g.normalized());
  return normal;
}

/// What must hold after every step on a smooth surface.
inline void expect_in_order(const Field& field, const TriangleMesh& mesh, const MeshTopology& expected) {
  const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles);
  EXPECT_EQ(topology.components, expected.components);
  EXPECT_EQ(topology.genus, expected.genus);
  EXPECT_EQ(folded_fraction(mesh.position, normals(field, mesh), mesh.triangles), 0);
  EXPECT_EQ(self_intersections(mesh.position, mesh.triangles), 0u);
  EXPECT_LE(angles_outside(mesh.position, mesh.triangles, 15, 140), 1e-3);
  EXPECT_TRUE(std::ranges::is_sorted(mesh.id, std::less_equal{}));
  EXPECT_LT(mesh.id.back(), mesh.next_id);
  EXPECT_EQ(mesh.rest_position.size(), mesh.vertex_count());
  for (const Vec3& x : mesh.position) {
    const ValueAndGradient at = field.value_and_gradient(x);
    EXPECT_LE(std::abs(at.f) / at.g.norm(), 1.001 * ProjectionOptions{}.tolerance * field.length_scale());
  }
}

}  // namespace kappaflow::testing
