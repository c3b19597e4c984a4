// Names beside the curves of a plot.
#pragma once

#include <vector>

namespace kappaflow {

/// Places in [low, high] that are at least `gap` apart and as near to those that are wanted as can be (least
/// squares); in the order of `wanted`, which keeps theirs. Where there is no room for all they are closer.
std::vector<double> spread_out(const std::vector<double>& wanted, double gap, double low, double high);

}  // namespace kappaflow
