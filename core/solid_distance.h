// Signed distance to closed triangle surfaces.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/triangle_tree.h"
#include "core/types.h"

namespace kappaflow {

/// The point of a solid's surface that is nearest to a given one.
struct SurfacePoint {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 normal =
      Vec3::Zero();     ///< of its triangle (of one of them at an edge or a corner), unit, out of the solid
  double distance = 0;  ///< from the given point: positive outside the solid, negative inside [m]
};

/// Throws InvalidInput for a vertex index out of range, or a vertex that is not finite.
void check_surface(const TriangleSurface& surface);

/// Distance to one closed triangle surface that is oriented outward and whose neighbouring triangles share
/// their vertices by index, through a tree of bounding boxes. The side is told by the angle-weighted
/// pseudonormal of the nearest face, edge or vertex (Baerentzen & Aanaes 2005): that of a surface that does
/// not pass through itself; solids_of() parts one whose pieces do. Triangles without area are ignored.
class SolidDistance {
 public:
  /// Throws InvalidInput for a vertex index out of range, a vertex that is not finite, or no triangle with an
  /// area.
  explicit SolidDistance(const TriangleSurface& surface);

  /// May be called from many threads.
  SurfacePoint nearest(const Vec3& x) const;

 private:
  /// Pseudonormals of corners, edges and face, by NearestOnTriangle::Feature; their length does not matter.
  using Normals = std::array<Vec3, 7>;

  std::vector<Normals> normals_;  // of the tree's triangles
  std::optional<TriangleTree> tree_;
};

/// The nearest surface point of the union of several solids: outside all of them the exact distance, inside
/// at least as deep as within any one. At infinity without solids.
SurfacePoint nearest_of_union(std::span<const SolidDistance> solids, const Vec3& x);

}  // namespace kappaflow
