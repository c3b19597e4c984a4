// How deep a point is inside the walls: exact signed distance to closed triangle surfaces.
#pragma once

#include <span>
#include <vector>

#include "core/solids.h"

namespace kappaflow {

/// Signed distance to the walls.
class WallDistance {
 public:
  /// walls: as solids_of() takes them. Copied.
  explicit WallDistance(std::span<const TriangleSurface> walls) : solids_(solid_distances(walls)) {}

  /// How deep x [m] is inside the walls [m]: distance to a wall's surface, > 0 inside, < 0 outside; the
  /// largest over the solids, so where they overlap a lower bound of the depth in their union. Minus infinity
  /// without walls. May be called from many threads.
  double depth(const Vec3& x) const { return -nearest_of_union(solids_, x).distance; }

 private:
  std::vector<SolidDistance> solids_;
};

}  // namespace kappaflow
