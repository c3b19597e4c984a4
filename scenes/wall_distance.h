// How deep a point is inside the walls: exact signed distance to closed triangle surfaces.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Signed distance to solids. Each solid has a bounding-volume tree over its triangles; the side is told by
/// the angle-weighted pseudonormal of the nearest face, edge or vertex (Baerentzen & Aanaes 2005), exact up
/// to rounding.
class WallDistance {
 public:
  /// walls: closed, oriented outward, neighbouring triangles sharing their vertices by index. Copied.
  explicit WallDistance(std::span<const TriangleSurface> walls);
  ~WallDistance();
  WallDistance(WallDistance&&) noexcept;
  WallDistance& operator=(WallDistance&&) noexcept;

  /// How deep x [m] is inside the walls [m]: distance to a wall's surface, > 0 inside, < 0 outside; the
  /// largest over the walls, so where walls overlap a lower bound of the depth in their union. Minus infinity
  /// without walls. May be called from many threads.
  double depth(const Vec3& x) const;

 private:
  class Solid;
  std::vector<Solid> solids_;
};

}  // namespace kappaflow
