// The triangles that close the gap between boundary loops of a mesh, or within one.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// One closed polygon that runs along `hole` as it runs and along each of the loops inside it against its
/// run; they hang together by bridges, passed there and back, where they are nearest to each other on one
/// side of the liquid. gradient: of f at the vertices.
std::vector<int> bridged_polygon(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                 std::span<const int> hole, std::span<const std::vector<int>> inside);

/// What the triangles that fill a polygon may be.
struct FillRules {
  double longest_edge = kInfinity;               ///< of edges that are not the polygon's [m]
  std::vector<std::pair<int, int>> taken_edges;  ///< of other triangles, the lower vertex first, sorted
  std::vector<Triangle> refused;                 ///< triangles, each with its corners sorted, sorted
};

/// Triangles over the corners of a polygon that hold its edges as they run: of all such sets the one of least
/// cost (Barequet & Sharir 1995). A triangle costs its longest edge squared, more the less it faces along the
/// gradients' opposites, and much more where it is refused, or faces away from them where they agree. None
/// where edges that are not too long and not taken do not suffice.
std::vector<Triangle> fill_polygon(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                   std::span<const int> polygon, const FillRules& rules);

}  // namespace kappaflow
