// Axes of plots: where they end, and their ticks at round values.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace kappaflow {

/// A mark on an axis; without a text it is a small one.
struct Tick {
  double at = 0;
  std::string text;  ///< "0.5", or "10^{-6}", which gnuplot raises
};

/// An axis from `low` to `high`.
struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<Tick> ticks;

  /// Where a value is: 0 at the low end, 1 at the high one.
  double share(double value) const;
};

/// Whether logarithms tell more: no value is below 0, of twenty at most one is 0 (but for rounding: 1e-12 of
/// the largest), and from the 5th to the 95th percentile the others span more than 2.5 decades.
bool spans_decades(std::span<const double> values);

enum class AxisEnds { of_data, round };

/// An axis that shows all values, with four to nine ticks that have texts; whole numbers have no ticks
/// between them. logarithmic: values must be above 0. Without values it is from 0 to 1.
Axis axis_of(std::span<const double> values, bool logarithmic, AxisEnds ends);

}  // namespace kappaflow
