#include "tools/runs/frame_rate.h"

#include "core/quantile.h"

namespace kappaflow {
namespace {

constexpr double kFallbackRate = 25;  // frames a second, where a run has one frame only

}  // namespace

double real_time_rate(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < times.size(); ++k) intervals.push_back(times[k] - times[k - 1]);
  const double interval = intervals.empty() ? 0 : quantile(intervals, 0.5);
  return interval > 0 ? 1 / interval : kFallbackRate;
}

}  // namespace kappaflow
