// Enright's test: a sphere is drawn out into a thin sheet and, since the flow turns round at half time, back.
#pragma once

#include <numbers>

#include "tools/experiments/flow_map_field.h"

namespace kappaflow {

/// Enright, Fedkiw, Ferziger & Mitchell 2002 (flow: LeVeque 1996), in the unit cube:
///   u =  2 sin^2(pi x) sin(2 pi y) sin(2 pi z) m,
///   v = -  sin(2 pi x) sin^2(pi y) sin(2 pi z) m,      m(t) = cos(pi t / kPeriod),
///   w = -  sin(2 pi x) sin(2 pi y) sin^2(pi z) m.
/// Time is a common factor of a steady flow U, so a material point moves along one path of U and has gone
/// s(t) = integral of m = (kPeriod / pi) sin(pi t / kPeriod) along it: forth until half time, then back.
struct EnrightFlow {
  static constexpr double kPeriod = 3;     ///< [s]; the body is itself again
  static constexpr double kRadius = 0.15;  ///< of the sphere at time 0 [m]
  static constexpr Point<double> kCentre{0.35, 0.35, 0.35};
  static constexpr double kLargestSpeed = 2;  ///< max |U| [m/s], at (1/2, 1/4, 1/4) and its mirror images
  /// [s]; keeps the error of flow_map() below 1e-9 m over the longest path, kPeriod / pi.
  static constexpr double kLongestStep = 0.0365;
  /// The sheet's thickness at half time [m]: a tenth of the surface has less below it, none less than a third
  /// of it. A projection that moves by a quarter of it at most cannot cross the sheet.
  static constexpr double kLengthScale = 0.01;

  /// U(x).
  template <class Number>
  static Point<Number> velocity(const Point<Number>& x);
  /// m(t), the factor of U.
  static double rate(double t) { return std::cos(std::numbers::pi / kPeriod * t); }
  /// s(t).
  static double path(double t) {
    return kPeriod / std::numbers::pi * std::sin(std::numbers::pi / kPeriod * t);
  }
  /// f at time 0: (R^2 - |x - c|^2) / (2 R), whose gradient has length 1 on the sphere.
  template <class Number>
  static Number initial_value(const Point<Number>& x);
  static Bounds bounds() { return {Vec3::Zero(), Vec3::Ones()}; }
};

template <class Number>
Point<Number> EnrightFlow::velocity(const Point<Number>& x) {
  std::array<Number, 3> sine, twice_square;  // sin(2 pi x), 2 sin^2(pi x) = 1 - cos(2 pi x)
  for (int a = 0; a < 3; ++a) {
    const auto [s, c] = sine_and_cosine(2 * std::numbers::pi * x[a]);
    sine[a] = s;
    twice_square[a] = 1.0 - c;
  }
  return {twice_square[0] * (sine[1] * sine[2]), -0.5 * (twice_square[1] * (sine[0] * sine[2])),
          -0.5 * (twice_square[2] * (sine[0] * sine[1]))};
}

template <class Number>
Number EnrightFlow::initial_value(const Point<Number>& x) {
  const Number dx = x[0] - kCentre[0], dy = x[1] - kCentre[1], dz = x[2] - kCentre[2];
  return 1 / (2 * kRadius) * (kRadius * kRadius - (dx * dx + dy * dy + dz * dz));
}

using EnrightField = FlowMapField<EnrightFlow>;
using EnrightMotion = FlowMapMotion<EnrightFlow>;
extern template class FlowMapField<EnrightFlow>;
extern template class FlowMapMotion<EnrightFlow>;

}  // namespace kappaflow
