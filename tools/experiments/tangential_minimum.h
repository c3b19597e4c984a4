// The damped least squares of the tangential velocity by the minimisers that Fujisawa et al. 2011 name beside
// their closed form, to compare with: the velocity methods use the closed form alone. All find the same
// minimum where it is well determined.
#pragma once

#include "core/named.h"
#include "surface/motion/tangential_rows.h"
#include "tools/experiments/minimisers.h"

namespace kappaflow {

/// Closed form: what the velocity methods do. Powell's method: what the paper did. BFGS: what it advises.
enum class Minimiser { closed_form, bfgs, powell };

inline constexpr Named<Minimiser> kMinimisers[] = {
    {"closed-form", Minimiser::closed_form}, {"bfgs", Minimiser::bfgs}, {"powell", Minimiser::powell}};

/// The damped sum of squares and its gradient, in units of a speed: z = y / scale.
template <int Rows>
struct DampedSum {
  double operator()(const Vec2& z) const {
    return (rows.R * z - b).squaredNorm() + lambda * lambda * z.squaredNorm();
  }
  double operator()(const Vec2& z, Vec2& gradient) const {
    gradient = 2 * (rows.R.transpose() * (rows.R * z - b) + lambda * lambda * z);
    return (*this)(z);
  }

  const TangentialRows<Rows>& rows;
  Eigen::Matrix<double, Rows, 1> b;  // rows.b / scale
  double lambda;
};

/// The minimum of |R y - b|^2 + lambda^2 |y|^2.
struct TangentialMinimum {
  Vec2 y;             ///< [m/s]
  double confidence;  ///< of solve_damped(), however y was found
  int evaluations;    ///< of the sum; 1 for the closed form
};

/// Finds it from y = start [m/s], which the closed form needs not. scale: a speed that y is measured in, so
/// that the minimiser's tolerances are dimensionless [m/s]; where it is 0 nothing moves, and any will do.
template <int Rows>
TangentialMinimum minimise(const TangentialRows<Rows>& rows, double lambda, double scale, Minimiser minimiser,
                           const Vec2& start = Vec2::Zero(), const MinimiserOptions& options = {}) {
  const DampedSolution closed = solve_damped(rows, lambda);
  if (minimiser == Minimiser::closed_form) return {closed.y, closed.confidence, 1};
  const double unit = scale > 0 ? scale : 1;
  const DampedSum<Rows> sum{rows, rows.b / unit, lambda};
  const Vec2 z = start / unit;
  const Minimum<2> minimum =
      minimiser == Minimiser::bfgs ? minimise_bfgs<2>(sum, z, options) : minimise_powell<2>(sum, z, options);
  return {unit * minimum.x, closed.confidence, minimum.evaluations};
}

}  // namespace kappaflow
