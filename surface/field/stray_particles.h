// Particles so far from all others that no surface can be near them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// The indices, ascending, of all kernels but those that have no part in f = 0: within the support of kernel
/// i, f <= sum_j w_j - T over the kernels within reach_i + reach_j of it, itself included; where that is
/// negative, so is f, with it and without. All where their box has few cells for their number: a cell grid
/// copes with that. One entry a kernel; requires positive reaches.
std::vector<std::uint32_t> without_strays(std::span<const Vec3> position, std::span<const double> reach,
                                          std::span<const double> weight, double threshold);

}  // namespace kappaflow
