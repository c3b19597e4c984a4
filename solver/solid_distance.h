// Signed distance to closed triangle surfaces.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// The point of a solid's surface that is nearest to a given one.
struct SurfacePoint {
  Vec3 position;        ///< [m]
  Vec3 normal;          ///< of its triangle, unit, out of the solid
  double distance = 0;  ///< from the given point: positive outside the solid, negative inside [m]
};

/// Distance to one closed triangle surface that is oriented outward, through a tree of bounding boxes. Where
/// several triangles are equally near, the one whose plane is furthest decides the sign, which is right at
/// edges and corners without knowing which triangles share them (Huang, Li, Crawfis & Lin, "A complete
/// distance field representation", 2001). Triangles without area are ignored.
class SolidDistance {
 public:
  /// Throws InvalidInput for a vertex index out of range, a vertex that is not finite, or no triangle with an
  /// area.
  explicit SolidDistance(const TriangleSurface& surface);

  SurfacePoint nearest(const Vec3& x) const;

 private:
  struct Face {
    std::array<Vec3, 3> corner;
    Vec3 normal;
  };
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t begin, end;  // faces
    std::uint32_t right;       // child; the left one is the next node. 0: a leaf
  };
  struct Search;

  std::uint32_t build(std::uint32_t begin, std::uint32_t end);
  void visit(std::uint32_t node, Search& search) const;

  std::vector<Face> faces_;
  std::vector<Node> nodes_;
};

/// The nearest surface point of the union of several solids: outside all of them the exact distance, inside
/// at least as deep as within any one.
SurfacePoint nearest_of_union(std::span<const SolidDistance> solids, const Vec3& x);

}  // namespace kappaflow
