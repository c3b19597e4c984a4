// Which of many points is nearest, and how far away.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// For each of `places` the number of the point that is nearest to it, the first of them if several are.
/// Precondition: there is a point.
std::vector<std::uint32_t> nearest_points(std::span<const Vec3> points, std::span<const Vec3> places);

/// For each point the squared distance to the nearest of the others [m2]. Precondition: there are two points.
std::vector<double> nearest_neighbour_squares(std::span<const Vec3> points);

}  // namespace kappaflow
