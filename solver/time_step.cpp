#include "solver/time_step.h"

#include <cmath>
#include <limits>

namespace kappaflow {

double cfl_time_step(double speed, double acceleration, double distance) {
  const double divisor = speed + std::sqrt(speed * speed + 4 * acceleration * distance);
  return divisor > 0 ? 2 * distance / divisor : std::numeric_limits<double>::infinity();
}

double fit_time_step(double longest, double time_left) {
  if (time_left <= longest) return time_left;
  return time_left < 2 * longest ? 0.5 * time_left : longest;
}

}  // namespace kappaflow
