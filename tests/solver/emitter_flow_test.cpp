// Emitters with a profile, a ramp or a motion.
#include "solver/emitter_flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/errors.h"
#include "solver/emitter.h"
#include "solver/fluid_solver.h"
#include "tests/solver/streams.h"

namespace kappaflow {
namespace {

using test::downward;
using test::run;

constexpr double kSpacing = 0.02;

FluidOptions options(const Emitter& emitter) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 1e-6;
  o.gravity.setZero();
  o.emitters = {emitter};
  return o;
}

SpeedProfile profile_of(const Emitter& e) {
  return {e, emitter_layer(e, kSpacing)};
}

TEST(SpeedProfile, IsHagenPoiseuillesInADisc) {
  Emitter e = downward(0.1, 1);
  e.profile = FlowProfile::parabolic;
  const SpeedProfile profile = profile_of(e);
  const double center = profile.at(Vec3::Zero());
  EXPECT_NEAR(center, 2, 0.1) << "twice the mean";
  for (const double r : {0.02, 0.05, 0.09})
    EXPECT_NEAR(profile.at(r * Vec3(0.6, 0, 0.8)), center * (1 - r * r / 0.01), 1e-12);
  EXPECT_EQ(profile.at(Vec3(0.1001, 0, 0)), 0);
  double sum = 0;
  const std::vector<Vec3> layer = emitter_layer(e, kSpacing);
  for (const Vec3& x : layer) sum += profile.at(x);
  EXPECT_NEAR(sum / static_cast<double>(layer.size()), 1, 1e-12);
}

// It solves Poisson's equation with a constant right-hand side, and is 0 at the walls.
TEST(SpeedProfile, IsDevelopedFlowInARectangle) {
  Emitter e;
  e.mouth = RectangleMouth{0.3, 0.1, Vec3(0, 1, 0)};
  e.direction = Vec3(0, 0, 1);
  e.profile = FlowProfile::parabolic;
  const SpeedProfile profile = profile_of(e);
  const auto at = [&](double x, double y) { return profile.at(Vec3(x, y, 0)); };
  const auto laplacian = [&](double x, double y) {
    constexpr double h = 4e-3;
    return (at(x + h, y) + at(x - h, y) + at(x, y + h) + at(x, y - h) - 4 * at(x, y)) / (h * h);
  };
  const double center = laplacian(0, 0);
  for (const Vec2& x : {Vec2(0.05, 0.01), Vec2(0.1, -0.03), Vec2(-0.12, 0.02), Vec2(0.02, 0.04)})
    EXPECT_NEAR(laplacian(x.x(), x.y()), center, 0.01 * std::abs(center)) << x.transpose();
  for (const double share : {-1.0, 0.3, 0.8}) {
    EXPECT_LT(at(0.1499999, 0.05 * share), 1e-3);
    EXPECT_LT(at(0.15 * share, 0.0499999), 1e-3);
  }
  EXPECT_NEAR(-center, 8 * at(0, 0) / (0.1 * 0.1), 0.02 * -center) << "plane flow far from the short sides";
}

/// Particles that are past the mouth at the origin.
double out_of(const FluidSolver& s, const Vec3& direction) {
  double out = 0;
  for (const Vec3& x : s.particles().position) out += x.dot(direction) >= 0;
  return out;
}

TEST(EmitterFlow, VolumeIsMeanSpeedTimesAreaTimesTimeWhateverTheProfile) {
  Emitter disc = downward(0.1, 0.7), slot = disc;
  slot.mouth = RectangleMouth{0.3, 0.1, Vec3(0, 0, 1)};
  for (Emitter e : {disc, slot}) {
    e.profile = FlowProfile::parabolic;
    FluidSolver s(options(e), {}, {}, {});
    run(s, 0.3);
    const double layers = out_of(s, Vec3(0, -1, 0)) / static_cast<double>(emitter_layer(e, kSpacing).size());
    EXPECT_NEAR(layers, 0.7 * 0.3 / kSpacing, 1);
    // The middle is ahead of the rim, in the nozzle too.
    const Particles p = s.particles();
    double ahead = 0, behind = 0;
    const SpeedProfile profile = profile_of(e);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3 x(p.position[i].x(), 0, p.position[i].z());
      if (x.norm() < 0.025) ahead = std::max(ahead, -p.position[i].y());
      if (profile.at(x) > 0.01 && profile.at(x) < 0.6) behind = std::max(behind, -p.position[i].y());
      if (p.position[i].y() > 1e-4) {
        EXPECT_LT((p.velocity[i] - Vec3(0, -0.7 * profile.at(x), 0)).norm(), 1e-4);
      }
    }
    EXPECT_GT(ahead, 0.9 * profile.largest() * 0.21);
    EXPECT_LT(behind, 0.18);
    EXPECT_GT(behind, 0) << "slow parts were looked at";
  }
}

TEST(EmitterFlow, EndAndLimitHoldWithAProfile) {
  Emitter e = downward(0.1, 1);
  e.profile = FlowProfile::parabolic;
  e.end = 0.2;
  const double layer = static_cast<double>(emitter_layer(e, kSpacing).size());
  FluidSolver ended(options(e), {}, {}, {});
  run(ended, 0.6);
  EXPECT_NEAR(static_cast<double>(ended.size()) / layer, 0.2 / kSpacing, 0.5);
  e.end = std::numeric_limits<double>::infinity();
  e.max_particles = 300;
  FluidSolver limited(options(e), {}, {}, {});
  run(limited, 0.6);
  EXPECT_LE(limited.size(), 300u);
  EXPECT_GT(limited.size(), 200u);
}

TEST(EmitterFlow, VolumeIsTheIntegralOfTheRamp) {
  Emitter e = downward(0.05, 0);
  e.ramp.keys = {{0.1, 0.2}, {0.3, 1}, {0.35, 0}, {0.4, 0}, {0.5, 0.6}};
  const double integral = 0.1 * 0.2 + 0.2 * 0.6 + 0.05 * 0.5 + 0.1 * 0.3 + 0.1 * 0.6;  // until 0.6 s
  for (const double step : {0.5e-3, 1.7e-3, 5e-3}) {
    FluidOptions o = options(e);
    o.max_time_step = step;
    FluidSolver s(o, {}, {}, {});
    run(s, 0.38);
    const Particles standing = s.particles();
    for (std::size_t i = 0; i < standing.size(); ++i)
      if (standing.position[i].y() > 1e-4) {
        EXPECT_LT(standing.velocity[i].norm(), 1e-5) << i;
      }
    run(s, 0.6);
    const double layers = out_of(s, Vec3(0, -1, 0)) / static_cast<double>(emitter_layer(e, kSpacing).size());
    EXPECT_NEAR(layers, integral / kSpacing, 1) << step;
    // What is led lies where the integral says, layer by layer.
    for (const Vec3& x : s.particles().position) {
      if (x.y() < 1e-4) continue;
      const double behind = (integral + x.y()) / kSpacing - 0.5;
      EXPECT_NEAR(behind, std::round(behind), 1e-3);
    }
  }
}

TEST(EmitterFlow, ConstantRampIsConstantSpeed) {
  const auto positions = [](const Emitter& e) {
    FluidSolver s(options(e), {}, {}, {});
    run(s, 0.2);
    return s.particles().position;
  };
  const Emitter constant = downward(0.06, 0.7);
  Emitter ramp = constant;
  ramp.ramp.keys = {{0, 0.7}, {0.05, 0.7}, {0.1, 0.7}};
  const std::vector<Vec3> one = positions(constant), other = positions(ramp);
  ASSERT_EQ(one.size(), other.size());
  // Led by the nozzle's position and not by a velocity: rounding.
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LT((one[i] - other[i]).norm(), 1e-4 * kSpacing);
}

// A nozzle that speeds up sideways, X = t^2, lays particles that fly on as they left: x = X(s) + 2 s (t - s),
// s when the layer was at the mouth.
TEST(EmitterFlow, MovingNozzleLaysALine) {
  constexpr double kSpeed = 1, kEnd = 0.3;
  Emitter e = downward(0.75 * kSpacing, kSpeed);
  e.motion.keys = {{0, Vec3::Zero(), 0}, {1, Vec3(2, 0, 0), 0}};
  ASSERT_EQ(emitter_layer(e, kSpacing).size(), 4u);
  FluidOptions o = options(e);
  o.kinematic_viscosity = 0;
  o.max_time_step = 1e-3;
  FluidSolver s(o, {}, {}, {});
  run(s, kEnd);
  const Particles p = s.particles();
  ASSERT_EQ(p.size() % 4, 0u);
  int laid = 0;
  for (std::size_t layer = 0; layer < p.size() / 4; ++layer) {
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) mean += 0.25 * p.position[4 * layer + k];
    const double left = (static_cast<double>(layer) + 0.5) * kSpacing / kSpeed;
    const double since = std::max(0.0, kEnd - left), at = std::min(left, kEnd);
    const Vec3 expected(at * at + 2 * at * since, kSpeed * (left - kEnd), 0);
    EXPECT_LT((mean - expected).norm(), left > kEnd ? 1e-5 : 2 * o.max_time_step) << layer;
    laid += left < kEnd;
  }
  EXPECT_EQ(laid, 15);
}

// What is led turns with the nozzle as a rigid body, and flows along its axis of then.
TEST(EmitterFlow, TurningNozzleLeadsRigidly) {
  Emitter e = downward(0.06, 0.4);
  e.motion.axis = Vec3(0.6, 0, 0.8);
  e.motion.point = Vec3(0.1, 0.05, 0);
  e.motion.keys = {{0, Vec3(0.2, 0, 0), 3}, {0.2, Vec3(0, 0.1, 0), -4}};
  FluidSolver s(options(e), {}, {}, {});
  const std::vector<Vec3> layer = emitter_layer(e, kSpacing);
  int led = 0;
  for (int k = 0; k < 60; ++k) {
    s.step(1);
    const RigidPose pose = e.motion.pose(s.time());
    for (const Vec3& world : s.particles().position) {
      const Vec3 x = pose.inverse(world);
      if (x.y() < 1e-4 || x.norm() > 0.08) continue;
      ++led;
      double nearest = 1;
      for (const Vec3& in_layer : layer)
        nearest = std::min(nearest, (Vec3(x.x(), 0, x.z()) - in_layer).norm());
      EXPECT_LT(nearest, 1e-3 * kSpacing);
      const double row = (0.4 * s.time() + x.y()) / kSpacing - 0.5;
      EXPECT_NEAR(row, std::round(row), 1e-3);
    }
  }
  EXPECT_GT(led, 1000);
}

/// A profile, a ramp and a motion at once.
FluidOptions everything() {
  Emitter e = downward(0.08, 0);
  e.profile = FlowProfile::parabolic;
  e.ramp.keys = {{0, 0.3}, {0.05, 1.2}};
  e.motion.keys = {{0, Vec3(0.5, 0, 0), 2}};
  FluidOptions o = options(e);
  o.gravity_table.keys = {{0, Vec3(0, -9.81, 0)}, {0.1, Vec3(5, -2, 0)}};
  return o;
}

TEST(EmitterFlow, SameBitsWithAnyNumberOfThreadsAndWhenReadBack) {
  const auto after = [](std::size_t threads, bool saved) {
    return test::after_steps(everything(), 50, threads, saved)->particles();
  };
  const Particles one = after(1, false);
  for (const Particles& other : {after(4, false), after(2, true)}) {
    EXPECT_EQ(other.position, one.position);
    EXPECT_EQ(other.velocity, one.velocity);
  }
}

TEST(EmitterFlow, MistakesAreRefused) {
  const auto refused = [](std::vector<TimeTable<double>::Key> ramp) {
    Emitter e = downward(0.05, 0);
    e.ramp.keys = std::move(ramp);
    EXPECT_THROW(check_emitter(e, kSpacing, 1), InvalidInput);
  };
  refused({{0, 1}, {0, 2}});
  refused({{0, 1}, {1, -1}});
  refused({{0, std::nan("")}});
  refused({{0, 0}, {1, 0}});  // nothing ever
  Emitter e = downward(0.05, 0);
  e.ramp.keys = {{0, 0}, {1, 1}};
  EXPECT_NO_THROW(check_emitter(e, kSpacing, 1));
}

}  // namespace
}  // namespace kappaflow
