// The exact implicit function of a body that a known flow carries along: a field without particles, whose
// material motion is known.
#pragma once

#include <fmt/format.h>

#include <span>

#include "core/errors.h"
#include "core/parallel.h"
#include "surface/field/field.h"
#include "tools/experiments/flow_map.h"

namespace kappaflow {

/// The velocity of the flow at x and time t, u = m(t) U(x) [m/s].
template <class Flow>
Vec3 flow_velocity(const Vec3& x, double t) {
  const Point<double> U = Flow::velocity(Point<double>{x[0], x[1], x[2]});
  return Flow::rate(t) * Vec3(U[0], U[1], U[2]);
}

/// Moves material points from time t_from to time t_to [s], either of which may be the earlier.
template <class Flow>
void carry(std::span<Vec3> points, double t_from, double t_to) {
  const double s = Flow::path(t_to) - Flow::path(t_from);
  parallel_for(points.size(), [&](std::size_t i) {
    const Point<double> x = flow_map<Flow>(s, Point<double>{points[i][0], points[i][1], points[i][2]});
    points[i] = {x[0], x[1], x[2]};
  });
}

/// f(x, t) = f_0(X(x, t)), where the flow takes X to x from time 0 to t. The flow is u(x, t) = m(t) U(x): X
/// is found by going back along the steady U for s(t) = integral of m.
///
/// A Flow has, all static: velocity(Point<Number>), which is U, and initial_value(Point<Number>), which is
/// f_0, for numbers and Taylor polynomials; rate(t), which is m, and path(t), which is s; bounds(), outside
/// of which f < 0 at all times; kLargestSpeed, max |U|; kLengthScale; kLongestStep of flow_map().
template <class Flow>
class FlowMapField final : public Field {
 public:
  explicit FlowMapField(double time) : time_(time), rate_(Flow::rate(time)), path_(Flow::path(time)) {}

  double time() const override { return time_; }
  /// Space derivatives are those of the computed f. Time derivatives are those of f_t = -u . grad f.
  Jet jet(const Vec3& x) const override;
  ValueAndGradient value_and_gradient(const Vec3& x) const override;
  Bounds bounds() const override { return Flow::bounds(); }
  double length_scale() const override { return Flow::kLengthScale; }
  double fastest_speed() const override { return std::abs(rate_) * Flow::kLargestSpeed; }
  std::optional<Vec3> material_velocity(const Vec3& x) const override {
    return flow_velocity<Flow>(x, time_);
  }
  bool moves_with_material() const override { return true; }

 private:
  template <int Degree>
  Taylor<Degree> value(const Vec3& x) const {
    return Flow::initial_value(flow_map<Flow>(-path_, taylor_variables<Degree>(x)));
  }

  double time_, rate_, path_;
};

/// A FlowMapField that moves from t0 to t1.
template <class Flow>
class FlowMapMotion final : public FieldMotion {
 public:
  /// Throws InvalidInput unless t0 < t1.
  FlowMapMotion(double t0, double t1) : t0_(t0), t1_(t1) {
    if (!(t0 < t1))
      throw InvalidInput(
          fmt::format("a motion from {} s to {} s; its end must be later than its start", t0, t1));
  }

  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  /// Throws InvalidInput outside [t0, t1]. A field holds no more than its time, so none is kept.
  std::shared_ptr<const Field> at(double t) override {
    if (!(t >= t0_ && t <= t1_))
      throw InvalidInput(fmt::format("a field at {} s was asked of a motion from {} s to {} s", t, t0_, t1_));
    return std::make_shared<FlowMapField<Flow>>(t);
  }

 private:
  double t0_, t1_;
};

template <class Flow>
Jet FlowMapField<Flow>::jet(const Vec3& x) const {
  const Taylor<3> f = value<3>(x);
  const Point<Taylor<2>> U = Flow::velocity(taylor_variables<2>(x));
  const Taylor<2> f_t = -rate_ * (U[0] * f.derivative(0) + U[1] * f.derivative(1) + U[2] * f.derivative(2));
  const double speed = std::abs(rate_) * Vec3(U[0].value(), U[1].value(), U[2].value()).norm();
  return jet_of(f, f_t, Flow::kLengthScale, speed);
}

template <class Flow>
ValueAndGradient FlowMapField<Flow>::value_and_gradient(const Vec3& x) const {
  const Taylor<1> f = value<1>(x);
  return {f.value(), f.gradient()};
}

}  // namespace kappaflow
