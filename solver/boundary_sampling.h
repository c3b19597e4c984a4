// Fixed particles that stand for the walls.
#pragma once

#include <span>
#include <vector>

#include "core/solid_wall.h"

namespace kappaflow {

/// How deep below a wall's surface its particles lie, in spacings; see boundary.cpp for why.
inline constexpr double kWallDepth = 0.94;
/// The thinnest wall that has room for them, in spacings.
inline constexpr double kThinnestWall = 2 * kWallDepth;

/// A particle of a wall.
struct WallSample {
  Vec3 position;  ///< [m]
  Vec3 normal;    ///< of the face that it lies under, unit, out of the solid
};

/// Whether they belong to opposite sides of a wall: however thin it is, these know nothing of each other.
inline bool opposite(const Vec3& normal, const Vec3& other) {
  return normal.dot(other) < -0.5;
}

/// Particles kWallDepth below the surface of the union of the solids: liquid then rests about half a spacing
/// off the wall. A Poisson-disk set (dart throwing in a fixed pseudo-random order): no two under the same
/// side are nearer than 0.6 spacing, and no place of the layer is further than about that from one. Faces
/// that another solid covers get none. walls: where they are at t = 0, whatever their motions. Throws
/// InvalidInput where a wall is thinner than kThinnestWall, or for walls so large that the places where a
/// particle may lie cannot be counted in 32 bits.
std::vector<WallSample> sample_walls(std::span<const SolidWall> walls, double spacing);

}  // namespace kappaflow
