// The smoothing kernel: the cubic spline of Monaghan & Lattanzio, "A refined particle method for
// astrophysical problems" (1985), normalised in three dimensions.
#pragma once

#include <algorithm>
#include <numbers>

#include "core/wide.h"

namespace kappaflow {

/// W(r) = sigma (2 (1-q)^3_+ - 8 (1/2-q)^3_+), q = r / support, sigma = 8 / (pi support^3) [1/m3]. Zero from
/// r = support. Its integral over space is 1. With support = 2 spacing the sum over a cubic lattice
/// is 1.00003 / spacing^3, so a lattice of volumes spacing^3 starts at rest density. Branch-free, for one
/// distance or eight.
class CubicSpline {
 public:
  /// support > 0 [m]
  explicit CubicSpline(float support)
      : support_(support),
        inverse_support_(1 / support),
        sigma_(8 / (std::numbers::pi_v<float> * support * support * support)) {}

  float support() const { return support_; }

  /// W [1/m3] at the distance r >= 0 [m]
  float value(float r) const { return value_at(r * inverse_support_); }
  Wide value(const Wide& r) const { return value_at<Wide>(r * inverse_support_); }

  /// F(r) = W'(r) / r <= 0 [1/m5], so that grad W(x) = F(|x|) x; the gradient is with respect to x. Finite at
  /// r = 0.
  float gradient_factor(float r) const { return gradient_factor_at(std::max(r * inverse_support_, 1e-6f)); }
  Wide gradient_factor(const Wide& r) const {
    return gradient_factor_at<Wide>((r * inverse_support_).max(1e-6f));
  }
  /// -F(0), the largest of all
  float largest_gradient_factor() const { return 12 * sigma_ * inverse_support_ * inverse_support_; }

 private:
  static float positive_part(float x) { return std::max(x, 0.0f); }
  static Wide positive_part(const Wide& x) { return x.max(0.0f); }

  template <class T>
  T value_at(const T& q) const {
    const T outer = positive_part(1 - q), inner = positive_part(0.5f - q);
    return sigma_ * (2 * outer * outer * outer - 8 * inner * inner * inner);
  }
  template <class T>
  T gradient_factor_at(const T& q) const {
    const T outer = positive_part(1 - q), inner = positive_part(0.5f - q);
    return -6 * sigma_ * inverse_support_ * inverse_support_ * (outer * outer - 4 * inner * inner) / q;
  }

  float support_, inverse_support_, sigma_;
};

/// (W / W(spacing))^4 of a kernel whose support is two spacings, at the distance q [spacings]: how much two
/// particles crowd each other (Monaghan, "SPH without a tensile instability", 2000).
inline Wide crowding(const Wide& q) {
  const Wide outer = (2 - q).max(0.0f), inner = (1 - q).max(0.0f);
  return (outer.cube() - 4 * inner.cube()).square().square();
}

}  // namespace kappaflow
