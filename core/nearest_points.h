// Which of many points is nearest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// For each of `places` the number of the point that is nearest to it, of several the first. Precondition:
/// there is a point.
std::vector<std::uint32_t> nearest_points(std::span<const Vec3> points, std::span<const Vec3> places);

}  // namespace kappaflow
