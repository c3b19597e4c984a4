#include "solver/emitter_flow.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace kappaflow {
namespace {

double shape(const DiscMouth& disc, double u, double v) {
  return std::max(0.0, 1 - (u * u + v * v) / (disc.radius * disc.radius));
}

/// cosh(x) / cosh(y), 0 <= x <= y; each of them alone would overflow.
double cosh_ratio(double x, double y) {
  return std::exp(x - y) * (1 + std::exp(-2 * x)) / (1 + std::exp(-2 * y));
}

/// Plane flow between the sides at |u| = a, less a harmonic function, of separated variables, that makes it 0
/// at |v| = b too.
double shape(const RectangleMouth& mouth, double u, double v) {
  constexpr int kTerms = 20;  // 1 / n^3 of the next is below 2e-5
  constexpr double kPi = std::numbers::pi;
  const double a = 0.5 * mouth.width, b = 0.5 * mouth.height;
  if (std::abs(u) >= a || std::abs(v) >= b) return 0;
  double sum = 0;
  for (int term = 0; term < kTerms; ++term) {
    const double n = 2 * term + 1, rate = n * kPi / (2 * a);
    const double part = cosh_ratio(rate * std::abs(v), rate * b) * std::cos(rate * u) / (n * n * n);
    sum += term % 2 == 0 ? part : -part;
  }
  return std::max(0.0, 1 - u * u / (a * a) - 32 / (kPi * kPi * kPi) * sum);
}

}  // namespace

double way_of_stream(const Emitter& emitter, double unit, double time) {
  if (std::isinf(time) && !emitter.ramp.empty()) {
    const auto& [last, speed] = emitter.ramp.keys.back();
    if (speed > 0) return time;
    time = std::max(emitter.start, last);  // it stands still from then on
  }
  return emitter.mean_speed(emitter.start, time) / unit * (time - emitter.start);
}

std::array<Vec3, 2> sides_of(const RectangleMouth& mouth, const Vec3& direction) {
  const Vec3 u = mouth.up.cross(direction).normalized();
  return {u, direction.cross(u)};
}

SpeedProfile::SpeedProfile(const Emitter& emitter, std::span<const Vec3> layer)
    : profile_(emitter.profile), mouth_(emitter.mouth) {
  const Vec3 direction = emitter.direction.normalized();
  if (const auto* rectangle = std::get_if<RectangleMouth>(&mouth_)) {
    const auto [u, v] = sides_of(*rectangle, direction);
    u_ = u, v_ = v;
  } else {
    u_ = direction.unitOrthogonal(), v_ = direction.cross(u_);
  }
  double sum = 0;
  for (const Vec3& x : layer) sum += shape_at(x);
  scale_ = static_cast<double>(layer.size()) / sum;
}

double SpeedProfile::at(const Vec3& x) const {
  return scale_ * shape_at(x);
}

double SpeedProfile::shape_at(const Vec3& x) const {
  if (profile_ == FlowProfile::uniform) return 1;
  return std::visit([&](const auto& mouth) { return shape(mouth, u_.dot(x), v_.dot(x)); }, mouth_);
}

}  // namespace kappaflow
