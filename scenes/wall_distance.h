// How deep a point is inside the walls: exact signed distance to closed triangle surfaces.
#pragma once

#include <utility>
#include <vector>

#include "core/solid_wall.h"

namespace kappaflow {

/// Signed distance to the walls as they are at t = 0.
class WallDistance {
 public:
  explicit WallDistance(std::vector<SolidWall> walls) : walls_(std::move(walls)) {}

  /// How deep x [m] is inside the walls [m]: distance to a wall's surface, > 0 inside, < 0 outside; the
  /// largest over the solids, so where they overlap a lower bound of the depth in their union. Minus infinity
  /// without walls. May be called from many threads.
  double depth(const Vec3& x) const { return -nearest_of_walls(walls_, x).distance; }

 private:
  std::vector<SolidWall> walls_;
};

}  // namespace kappaflow
