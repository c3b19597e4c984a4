// From floating point to whole numbers, whatever the number is.
#pragma once

#include <algorithm>

namespace kappaflow {

/// x without its fraction, within [least, most]; `least` where x is NaN. A mere cast of what does not fit is
/// undefined. Precondition: least <= most, both at most 2^53 from zero.
template <class Whole>
Whole whole_within(double x, Whole least, Whole most) {
  // In this order, for std::max(a, NaN) is a.
  return static_cast<Whole>(std::min(std::max(static_cast<double>(least), x), static_cast<double>(most)));
}

}  // namespace kappaflow
