#include "solver/time_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kappaflow {

double cfl_time_step(double speed, double acceleration, double distance) {
  const double divisor = speed + std::sqrt(speed * speed + 4 * acceleration * distance);
  return divisor > 0 ? 2 * distance / divisor : std::numeric_limits<double>::infinity();
}

double fit_time_step(double longest, double time_left) {
  constexpr double kRounding = 1e-9;  // of the sum of the steps before; no reason for one step more
  const double steps = std::max(1.0, std::ceil(time_left / longest - kRounding));
  return std::isinf(steps) ? longest : time_left / steps;
}

}  // namespace kappaflow
