// How the liquid of an emitter flows: how fast in time, across the mouth, and with a mouth that moves.
#pragma once

#include <array>
#include <span>
#include <variant>
#include <vector>

#include "solver/options.h"

namespace kappaflow {

/// The way of the mean stream from emitter.start to `time` >= start, in lengths of `unit` [m]. May be
/// infinite at infinity.
double way_of_stream(const Emitter& emitter, double unit, double time);

/// Developed laminar flow across a mouth: the speed over its mean.
class SpeedProfile {
 public:
  /// Scaled so that the mean over the points of a layer (emitter_layer()) is 1.
  SpeedProfile(const Emitter& emitter, std::span<const Vec3> layer);

  /// At a point in the plane of the mouth, from its centre [m]. uniform: 1. parabolic, in proportion to the
  /// solution of lap w = -1 with w = 0 at the mouth's rim: in a disc of radius R to 1 - |x|^2 / R^2
  /// (Hagen-Poiseuille); in a rectangle |u| <= a, |v| <= b to
  ///   1 - u^2 / a^2 - 32 / pi^3 sum over odd n of
  ///       (-1)^((n - 1) / 2) / n^3 cosh(n pi v / 2 a) / cosh(n pi b / 2 a) cos(n pi u / 2 a)
  /// (White, "Viscous fluid flow", 3rd edition (2006), section 3-3.3). 0 outside.
  double at(const Vec3& x) const;

  double largest() const { return at(Vec3::Zero()); }

 private:
  double shape_at(const Vec3& x) const;

  FlowProfile profile_;
  std::variant<DiscMouth, RectangleMouth> mouth_;
  Vec3 u_ = Vec3::Zero(), v_ = Vec3::Zero();  // along the sides of a rectangle, of length 1
  double scale_ = 1;
};

/// Unit vectors along a rectangle's width and height. Precondition: `up` points across the direction.
std::array<Vec3, 2> sides_of(const RectangleMouth& mouth, const Vec3& direction);

}  // namespace kappaflow
