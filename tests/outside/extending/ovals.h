// A field of one's own: Cassini's ovals, turned about the x axis, which split as their foci move apart.
#pragma once

#include <kappaflow/surface/field/field.h>
#include <kappaflow/surface/field/taylor.h>

#include <array>
#include <cmath>
#include <memory>

/// The points whose distances to the foci (-c, 0, 0) and (c, 0, 0) have the product b^2, b = 1 m, c = c_0 + u
/// t:
///   f = b^4 - (x^2 + y^2 + z^2 + c^2)^2 + 4 c^2 x^2,   f_t = -4 u c (x^2 + y^2 + z^2 + c^2 - 2 x^2).
/// One body while c < b, two from then on.
class Ovals final : public kappaflow::Field {
 public:
  static constexpr double kFirst = 0.8, kSpeed = 1;  ///< c_0 [m], u [m/s]

  explicit Ovals(double time) : time_(time), c_(kFirst + kSpeed * time) {}

  double time() const override { return time_; }
  kappaflow::Jet jet(const kappaflow::Vec3& x) const override {
    return kappaflow::jet_of(value(kappaflow::taylor_variables<3>(x)),
                             rate(kappaflow::taylor_variables<2>(x)), length_scale(), kSpeed);
  }
  kappaflow::ValueAndGradient value_and_gradient(const kappaflow::Vec3& x) const override {
    const kappaflow::Taylor<1> f = value(kappaflow::taylor_variables<1>(x));
    return {f.value(), f.gradient()};
  }
  kappaflow::Bounds bounds() const override {
    const kappaflow::Vec3 corner(std::sqrt(1 + c_ * c_), 1, 1);
    return {-corner, corner};
  }
  double length_scale() const override { return 0.4; }
  double fastest_speed() const override { return kSpeed; }

 private:
  template <class Number>
  Number value(const std::array<Number, 3>& p) const {
    const Number xx = p[0] * p[0], s = xx + p[1] * p[1] + p[2] * p[2] + c_ * c_;
    return 1 - s * s + 4 * c_ * c_ * xx;
  }
  template <class Number>
  Number rate(const std::array<Number, 3>& p) const {
    return -4 * kSpeed * c_ * (p[1] * p[1] + p[2] * p[2] - p[0] * p[0] + c_ * c_);
  }

  double time_, c_;
};

/// Their motion through one time step.
class MovingOvals final : public kappaflow::FieldMotion {
 public:
  MovingOvals(double t0, double t1) : t0_(t0), t1_(t1) {}
  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  std::shared_ptr<const kappaflow::Field> at(double t) override { return std::make_shared<Ovals>(t); }

 private:
  double t0_, t1_;
};
