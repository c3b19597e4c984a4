// How many frames a second a run has.
#pragma once

#include <vector>

namespace kappaflow {

/// Frames a second at which simulated time passes as fast as that of the viewer, but for frames that are not
/// equally far apart: one over the median interval; 25 of a single frame.
double real_time_rate(const std::vector<double>& times);

}  // namespace kappaflow
