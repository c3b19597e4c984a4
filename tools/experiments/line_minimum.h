// Searches along a line, for the minimisers.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

namespace kappaflow {

/// A place on a line and the function there.
struct LineMinimum {
  double t = 0;
  double value = 0;
};

/// Three places in order along the line, either way; the function at the middle one is no larger than at the
/// others.
struct Bracket {
  LineMinimum first, middle, last;
};

/// Goes downhill from t = 0, each step longer than the last by the golden ratio, until the function rises.
/// Where it never does, middle is the lowest place reached.
template <class Function>
Bracket bracket_minimum(const Function& f, double value_at_0, double step) {
  constexpr double kGoldenRatio = 1.6180339887498949;
  constexpr int kSteps = 100;
  Bracket b{.first = {0, value_at_0}, .middle = {step, f(step)}, .last = {}};
  if (!(b.middle.value < value_at_0)) std::swap(b.first, b.middle);
  for (int i = 0; i < kSteps; ++i) {
    const double t = b.middle.t + kGoldenRatio * (b.middle.t - b.first.t);
    b.last = {t, f(t)};
    if (!(b.last.value < b.middle.value)) return b;
    b.first = std::exchange(b.middle, b.last);
  }
  return b;
}

/// How far from a the parabola through three places has its vertex; not finite where they lie on a line.
inline double to_vertex(const LineMinimum& a, const LineMinimum& b, const LineMinimum& c) {
  const double by_b = (a.t - b.t) * (a.value - c.value), by_c = (a.t - c.t) * (a.value - b.value);
  return 0.5 * ((a.t - b.t) * by_b - (a.t - c.t) * by_c) / (by_c - by_b);
}

/// The minimum within a bracket by parabolas and golden sections (R. P. Brent, "Algorithms for Minimization
/// without Derivatives", 1973, chapter 5), to `relative` times |t| plus `absolute`.
template <class Function>
LineMinimum brent_minimum(const Function& f, const Bracket& bracket, double relative, double absolute) {
  constexpr double kGoldenSection = 0.3819660112501051;
  constexpr int kIterations = 100;
  double low = std::fmin(bracket.first.t, bracket.last.t), high = std::fmax(bracket.first.t, bracket.last.t);
  LineMinimum best = bracket.middle, second = bracket.first, third = bracket.last;
  if (third.value < second.value) std::swap(second, third);
  double move = high - low, move_before = move;
  for (int i = 0; i < kIterations; ++i) {
    const double smallest = relative * std::abs(best.t) + absolute, to_centre = 0.5 * (low + high) - best.t;
    if (std::abs(to_centre) + 0.5 * (high - low) <= 2 * smallest) break;
    // A parabola's move must stay inside and be shorter than half the last but one.
    const double longest = 0.5 * std::abs(std::exchange(move_before, move));
    move = to_vertex(best, second, third);
    if (!(std::abs(move) < longest && best.t + move > low && best.t + move < high)) {
      move_before = (to_centre > 0 ? high : low) - best.t;
      move = kGoldenSection * move_before;
    }
    if (std::abs(move) < smallest) move = std::copysign(smallest, to_centre);
    const LineMinimum tried{best.t + move, f(best.t + move)};
    const bool is_best = tried.value <= best.value;
    ((tried.t < best.t) == is_best ? high : low) = is_best ? best.t : tried.t;
    if (is_best)
      third = std::exchange(second, std::exchange(best, tried));
    else if (tried.value <= second.value || second.t == best.t)
      third = std::exchange(second, tried);
    else if (tried.value <= third.value || third.t == best.t || third.t == second.t)
      third = tried;
  }
  return best;
}

/// A place t > 0 where the function has fallen by a share of what its slope at 0 promises, and where its
/// slope is less steep: the weak Wolfe conditions. t = 0 where there is none. f(t, rate) -> value, and sets
/// the rate.
template <class Function>
LineMinimum wolfe_point(const Function& f, double value_at_0, double rate_at_0) {
  constexpr double kFall = 1e-4, kFlattening = 0.9;
  constexpr int kTrials = 100;
  double low = 0, high = std::numeric_limits<double>::infinity(), t = 1;
  for (int i = 0; i < kTrials; ++i) {
    double rate = 0;
    const double value = f(t, rate);
    if (!(value <= value_at_0 + kFall * t * rate_at_0))
      high = t;
    else if (rate < kFlattening * rate_at_0)
      low = t;
    else
      return {t, value};
    t = std::isinf(high) ? 2 * t : 0.5 * (low + high);
  }
  return {0, value_at_0};
}

}  // namespace kappaflow
