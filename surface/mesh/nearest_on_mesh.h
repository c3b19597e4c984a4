// The point of a mesh that is nearest to a given one.
#pragma once

#include <optional>

#include "core/triangle_tree.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Finds the nearest points of a mesh, which must outlive it and stay as it is.
class NearestOnMesh {
 public:
  explicit NearestOnMesh(const TriangleMesh& mesh);

  /// A point of the mesh, as the mean of the vertices of its triangle.
  struct Point {
    VertexBlend blend;
    double distance;  ///< from the given point [m]
  };

  /// May be called from many threads. nullopt where the mesh has no triangles.
  std::optional<Point> nearest(const Vec3& x) const;

 private:
  const TriangleMesh& mesh_;
  std::optional<TriangleTree> tree_;
};

}  // namespace kappaflow
