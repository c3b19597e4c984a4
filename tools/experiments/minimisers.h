// Minimises a function of N variables: Powell's directions, which need values alone (M. J. D. Powell, "An
// efficient method for finding the minimum of a function of several variables without calculating
// derivatives", The Computer Journal 7, 1964), and BFGS, which needs the gradient (J. Nocedal, S. Wright,
// "Numerical Optimization", 2006, section 6.1).
//
// Written here since the libraries at hand do not serve: NLopt's PRAXIS draws random numbers, the GNU
// Scientific Library is GPL and has no Powell, dlib brings X11 and BLAS along. Nothing is allocated.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/experiments/line_minimum.h"

namespace kappaflow {

struct MinimiserOptions {
  /// Stops when an iteration lowers the value by no more than this share of what all of them together have.
  /// The point's relative error is then about the square root of it, times the problem's condition.
  double tolerance = 1e-14;
  /// Or by no more than this share of the value itself, which near a minimum that is not 0 is sooner.
  double value_tolerance = 0;
  /// Of the line searches of Powell's method, relative to their length. Loose: the last parabola is better
  /// than that, and finer lines take three times the evaluations.
  double line_tolerance = 1e-3;
  double step = 1;           ///< length of the first steps, in the units of x
  int max_iterations = 100;  ///< each of them N line searches in Powell's method, and one in BFGS
};

template <int N>
struct Minimum {
  Eigen::Matrix<double, N, 1> x;
  double value = 0;
  int evaluations = 0;     ///< of the function, or of function and gradient together
  bool converged = false;  ///< to the tolerance, or as far as rounding allows
};

namespace minimisers {

/// Whether lowering the value by `gain` is not worth another iteration.
inline bool is_negligible(double gain, double start, double value, const MinimiserOptions& options) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  return gain <=
         options.tolerance * (start - value) + (options.value_tolerance + kRounding) * std::abs(value);
}

/// What Powell's method has at hand between two line searches.
template <int N, class Function>
struct PowellSearch {
  using Vector = Eigen::Matrix<double, N, 1>;

  double value_at(const Vector& x) {
    ++best.evaluations;
    return f(x);
  }
  /// Moves to the minimum along a direction; returns how much lower it is.
  double minimise_along(const Vector& direction) {
    constexpr double kAbsolute = 1e-7;
    const auto on_line = [&](double t) { return value_at(best.x + t * direction); };
    const double value_before = best.value;
    const LineMinimum line = brent_minimum(on_line, bracket_minimum(on_line, best.value, options.step),
                                           options.line_tolerance, kAbsolute * options.step);
    if (line.value < value_before) best.x += line.t * direction, best.value = line.value;
    return value_before - best.value;
  }
  /// Minimises along all directions in turn, then replaces the one of the largest gain by the way that they
  /// went together, unless that would make them dependent. Returns the gain.
  double iterate() {
    const Vector x_before = best.x;
    const double value_before = best.value;
    double largest_gain = 0;
    int largest = 0;
    for (int k = 0; k < N; ++k)
      if (const double gain = minimise_along(directions.col(k)); gain > largest_gain)
        largest_gain = gain, largest = k;
    const Vector way = best.x - x_before;
    const double beyond = value_at(best.x + way);
    const double gain = value_before - best.value, ahead = value_before - beyond,
                 bend = value_before - 2 * best.value + beyond, others = gain - largest_gain;
    if (!(ahead > 0 && 2 * bend * others * others < largest_gain * ahead * ahead)) return gain;
    directions.col(largest) = way.normalized();
    return gain + minimise_along(directions.col(largest));
  }

  const Function& f;
  const MinimiserOptions& options;
  Minimum<N> best;
  Eigen::Matrix<double, N, N> directions = Eigen::Matrix<double, N, N>::Identity();
};

}  // namespace minimisers

/// Powell's method. f(x) -> value.
template <int N, class Function>
Minimum<N> minimise_powell(const Function& f, const Eigen::Matrix<double, N, 1>& start,
                           const MinimiserOptions& options = {}) {
  minimisers::PowellSearch<N, Function> search{f, options, {.x = start, .value = f(start), .evaluations = 1}};
  Minimum<N>& best = search.best;
  const double value_at_start = best.value;
  for (int i = 0; i < options.max_iterations && !best.converged; ++i) {
    const double gain = search.iterate();
    best.converged = minimisers::is_negligible(gain, value_at_start, best.value, options);
  }
  return best;
}

/// BFGS with a line search for the weak Wolfe conditions by doubling and bisection (A. Lewis, M. Overton,
/// "Nonsmooth optimization via quasi-Newton methods", Mathematical Programming 141, 2013).
/// f(x, gradient) -> value, and sets the gradient.
template <int N, class Function>
Minimum<N> minimise_bfgs(const Function& f, const Eigen::Matrix<double, N, 1>& start,
                         const MinimiserOptions& options = {}) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  Vector gradient, new_gradient;
  Minimum<N> best{.x = start, .value = f(start, gradient), .evaluations = 1};
  const double value_at_start = best.value, slope = gradient.norm();
  Matrix inverse_hessian = (slope > 0 ? options.step / slope : 0) * Matrix::Identity();
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const Vector step = -inverse_hessian * gradient;
    const double decrease = -gradient.dot(step);  // twice what the model promises
    best.converged = minimisers::is_negligible(0.5 * decrease, value_at_start, best.value, options);
    if (best.converged) break;

    const auto evaluate = [&](double t, double& rate) {
      ++best.evaluations;
      const double value = f(best.x + t * step, new_gradient);
      rate = new_gradient.dot(step);
      return value;
    };
    const LineMinimum line = wolfe_point(evaluate, best.value, -decrease);
    if (line.t == 0) break;  // nothing lower to be found: rounding, or the gradient is not the function's
    const Vector moved = line.t * step, turned = new_gradient - gradient;
    const double bend = moved.dot(turned);
    if (iteration == 0) inverse_hessian = bend / turned.squaredNorm() * Matrix::Identity();
    const Matrix without = Matrix::Identity() - moved * turned.transpose() / bend;
    inverse_hessian = without * inverse_hessian * without.transpose() + moved * moved.transpose() / bend;
    best.x += moved;
    best.value = line.value;
    gradient = new_gradient;
  }
  return best;
}

}  // namespace kappaflow
