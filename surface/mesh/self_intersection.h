// Whether a mesh passes through itself.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// The number of pairs of triangles that pass through each other: an edge of one crosses the inside of the
/// other. Pairs that share an edge do not count (see folded_fraction()); of pairs that share one vertex, only
/// the edges opposite to it can cross: see triangles_cross().
std::size_t self_intersections(std::span<const Vec3> position, std::span<const Triangle> triangles);

/// The triangles of these pairs, ascending, each once. Pairs of two of the first `known` triangles are not
/// looked at.
std::vector<int> intersecting_triangles(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                        std::size_t known = 0);

}  // namespace kappaflow
