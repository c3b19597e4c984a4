// Cells of unbounded space.
#pragma once

#include <array>
#include <cstdint>

#include "core/types.h"
#include "core/whole_within.h"

namespace kappaflow {

using SpaceCell = std::array<std::int64_t, 3>;

/// The cell of the given size that holds x, counted from the origin: floor(x / size) along each axis; far
/// out, where double does not tell cells apart, the last one that it does.
inline SpaceCell space_cell(const Vec3& x, double size) {
  constexpr std::int64_t kFarthest = std::int64_t{1} << 52;
  const Vec3 cell = (x / size).array().floor();
  const auto index = [&](int a) { return whole_within(cell[a], -kFarthest, kFarthest); };
  return {index(0), index(1), index(2)};
}

}  // namespace kappaflow
