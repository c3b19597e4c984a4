#include "tools/pictures/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/quantile.h"

namespace kappaflow {
namespace {

constexpr double kDecades = 2.5;                     // more of them make an axis logarithmic
constexpr double kLeftOut = 0.05;                    // at either end, where that is decided
constexpr double kNearZero = 0.1;                    // of the high end: an axis that begins there begins at 0
constexpr double kZero = 1e-12;                      // of the largest value: what is left of 0 after rounding
constexpr double kFewDecades = 2;                    // up to as many have ticks at 2 and 5 with texts too
constexpr int kIntervals = 6;                        // between ticks with texts, at most
constexpr int kMostDecadeTicks = 7;                  // with texts
constexpr double kRounding = 1e-9;                   // of a step
constexpr double kPlainFrom = 1e-3, kPlainTo = 1e5;  // beyond, texts are powers of ten

/// The smallest of 1, 2 and 5 times the powers of ten that is not below.
double round_step(double least) {
  const double power = std::pow(10, std::floor(std::log10(least) + kRounding));
  const double digit = least / power * (1 - kRounding);
  return power * (digit <= 1 ? 1 : digit <= 2 ? 2 : digit <= 5 ? 5 : 10);
}

std::string power_text(int exponent) {
  return fmt::format("10^{{{}}}", exponent);
}

/// With as many decimals as the step has.
std::string linear_text(double value, double step, double largest) {
  if (value == 0) return "0";
  if (largest < kPlainFrom || largest >= kPlainTo) {
    const int exponent = static_cast<int>(std::floor(std::log10(largest) + kRounding));
    return fmt::format("{:.4g}·{}", value / std::pow(10, exponent), power_text(exponent));
  }
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + kRounding)));
  return fmt::format("{:.{}f}", value, decimals);
}

void add_linear_ticks(Axis& axis, double step) {
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  const auto first = static_cast<long>(std::ceil(axis.low / step - kRounding)),
             last = static_cast<long>(std::floor(axis.high / step + kRounding));
  for (long k = first; k <= last; ++k) {
    const double at = static_cast<double>(k) * step;
    axis.ticks.push_back({at, linear_text(at, step, largest)});
  }
}

Axis linear_axis(double low, double high, bool whole_numbers, AxisEnds ends) {
  if (low == high) {
    const double room = low == 0 ? 1 : std::abs(low) / 10;
    low -= room, high += room;
  }
  if (ends == AxisEnds::of_data && low > 0 && low < kNearZero * high) low = 0;
  double step = round_step((high - low) / kIntervals);
  if (whole_numbers) step = std::max(step, 1.0);
  Axis axis{low, high, false, {}};
  if (ends == AxisEnds::round) {
    axis.low = std::floor(low / step + kRounding) * step;
    axis.high = std::ceil(high / step - kRounding) * step;
  }
  add_linear_ticks(axis, step);
  return axis;
}

/// The texts of a decade: of its power of ten only, of 2 and 5 times that too, or none.
enum class DecadeTexts { none, power, two_and_five };

/// Ticks at the power of ten, and where that has a text at its multiples.
void add_decade(Axis& axis, int exponent, DecadeTexts texts) {
  const bool plain = axis.low >= kPlainFrom * (1 - kRounding) && axis.high < kPlainTo;
  for (int digit = 1; digit < (texts == DecadeTexts::none ? 2 : 10); ++digit) {
    const double at = digit * std::pow(10, exponent);
    if (at < axis.low * (1 - kRounding) || at > axis.high * (1 + kRounding)) continue;
    const bool has_text =
        digit == 1 ? texts != DecadeTexts::none : texts == DecadeTexts::two_and_five && 10 % digit == 0;
    const std::string power =
        digit == 1 ? power_text(exponent) : fmt::format("{}·{}", digit, power_text(exponent));
    axis.ticks.push_back({at, !has_text ? "" : plain ? fmt::format("{:.4g}", at) : power});
  }
}

Axis logarithmic_axis(double low, double high, AxisEnds ends) {
  const int first = static_cast<int>(std::floor(std::log10(low) + kRounding)),
            last = static_cast<int>(std::ceil(std::log10(high) - kRounding));
  Axis axis{low, high, true, {}};
  if (ends == AxisEnds::round || low == high) {
    axis.low = std::pow(10, first);
    axis.high = std::pow(10, std::max(last, first + 1));
  }
  const int decades = std::max(last, first + 1) - first, stride = decades / kMostDecadeTicks + 1;
  const bool few = std::log10(axis.high / axis.low) < kFewDecades;
  for (int exponent = first; exponent <= first + decades; ++exponent)
    add_decade(axis, exponent,
               few                      ? DecadeTexts::two_and_five
               : exponent % stride == 0 ? DecadeTexts::power
                                        : DecadeTexts::none);
  return axis;
}

}  // namespace

double Axis::share(double value) const {
  return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
}

bool spans_decades(std::span<const double> values) {
  if (values.empty() || std::ranges::min(values) < 0) return false;
  const double least = kZero * std::ranges::max(values);
  std::vector<double> positive;
  std::ranges::copy_if(values, std::back_inserter(positive), [=](double value) { return value > least; });
  const auto zeros = static_cast<double>(values.size() - positive.size());
  if (positive.empty() || zeros > kLeftOut * static_cast<double>(values.size())) return false;
  return std::log10(quantile(positive, 1 - kLeftOut) / quantile(positive, kLeftOut)) > kDecades;
}

Axis axis_of(std::span<const double> values, bool logarithmic, AxisEnds ends) {
  if (values.empty()) return linear_axis(0, 1, false, AxisEnds::round);
  const auto [low, high] = std::ranges::minmax(values);
  if (logarithmic) return logarithmic_axis(low, high, ends);
  const bool whole_numbers =
      std::ranges::all_of(values, [](double value) { return value == std::round(value); });
  return linear_axis(low, high, whole_numbers, ends);
}

}  // namespace kappaflow
