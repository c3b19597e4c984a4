// The value that a given share of others do not exceed, and the median.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace kappaflow {

/// The value at position floor(share (n - 1)) of the n >= 1 values in ascending order; share in [0, 1].
/// Reorders the values.
inline double quantile(std::span<double> values, double share) {
  const auto chosen =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), chosen, values.end());
  return *chosen;
}

/// The value at position floor(n / 2) of the n >= 1 values in ascending order: the median, and the larger of
/// the two in the middle where n is even. Reorders the values.
inline double upper_median(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace kappaflow
