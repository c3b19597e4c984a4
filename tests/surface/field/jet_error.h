// How far a jet is from another one.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "surface/field/jet.h"

namespace kappaflow::testing {

inline std::vector<double> components(const ThirdDerivatives& c) {
  return {c.xxx, c.xxy, c.xxz, c.xyy, c.xyz, c.xzz, c.yyy, c.yyz, c.yzz, c.zzz};
}

inline std::vector<double> components(const Mat3& m) {
  return {m.data(), m.data() + 9};
}
inline std::vector<double> components(const Vec3& v) {
  return {v.data(), v.data() + 3};
}
inline std::vector<double> components(double v) {
  return {v};
}

/// Largest difference over the largest component of the expected tensor, or over 1 where that is smaller:
/// lengths are about 1 m and speeds about 1 m/s in these cases, so 1 is the natural size of every derivative.
template <class T>
double scaled_error(const T& actual, const T& expected) {
  const auto a = components(actual), e = components(expected);
  double scale = 1, difference = 0;
  for (std::size_t i = 0; i < e.size(); ++i) {
    scale = std::max(scale, std::abs(e[i]));
    difference = std::max(difference, std::abs(a[i] - e[i]));
  }
  return difference / scale;
}

inline double largest_scaled_error(const Jet& actual, const Jet& expected) {
  return std::max({scaled_error(actual.f, expected.f), scaled_error(actual.g, expected.g),
                   scaled_error(actual.A, expected.A), scaled_error(actual.C, expected.C),
                   scaled_error(actual.f_t, expected.f_t), scaled_error(actual.g_t, expected.g_t),
                   scaled_error(actual.A_t, expected.A_t)});
}

}  // namespace kappaflow::testing
