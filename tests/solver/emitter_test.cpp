#include "solver/emitter.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <sstream>

#include "core/errors.h"
#include "core/particles.h"
#include "core/saved_state.h"
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
  o.gravity.setZero();
  o.emitters = {emitter};
  return o;
}

FluidSolver solver(const FluidOptions& o) {
  return {o, {}, {}, {}};
}

TEST(EmitterLayer, CoversTheMouthAcrossTheDirection) {
  Emitter e = downward(0.1, 1);
  e.direction = Vec3(1, 2, -3);
  const std::vector<Vec3> disc = emitter_layer(e, kSpacing);
  EXPECT_NEAR(static_cast<double>(disc.size()) * kSpacing * kSpacing, M_PI * 0.01, 0.1 * M_PI * 0.01);
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : disc) {
    EXPECT_NEAR(x.dot(e.direction), 0, 1e-14);
    EXPECT_LE(x.norm(), 0.1 * (1 + 1e-5));
    sum += x;
  }
  EXPECT_LT(sum.norm(), 1e-12);

  e.mouth = RectangleMouth{0.12, 0.06, Vec3(0, 1, 0)};
  e.direction = Vec3(1, 0, 0);
  const std::vector<Vec3> rectangle = emitter_layer(e, kSpacing);
  EXPECT_EQ(rectangle.size(), 6u * 3);
  Vec3 largest = Vec3::Zero();
  for (const Vec3& x : rectangle) largest = largest.cwiseMax(x.cwiseAbs());
  EXPECT_TRUE(largest.isApprox(Vec3(0, 0.02, 0.05), 1e-12)) << largest;
}

// Without forces the stream is a lattice that keeps rest density and the emitter's speed.
TEST(Emitter, StreamHasRestDensityAndSpeed) {
  FluidSolver s = solver(options(downward(0.08, 1)));
  run(s, 0.3);
  const Particles p = s.particles();
  const std::vector<float> density = s.densities();
  int inside = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LT((p.velocity[i] - Vec3(0, -1, 0)).norm(), 1e-3);
    if (std::hypot(p.position[i].x(), p.position[i].z()) > 0.05 || p.position[i].y() > 0 ||
        p.position[i].y() < -0.25)
      continue;
    ++inside;
    EXPECT_NEAR(density[i], 1000, 2);
  }
  EXPECT_GT(inside, 200);
  EXPECT_NO_THROW(check_particles(p));  // ids ascend
}

TEST(Emitter, FlowRateIsLayerTimesSpeedWhateverTheTimeStep) {
  for (const double step : {0.5e-3, 1.7e-3, 5e-3}) {
    FluidOptions o = options(downward(0.05, 0.7));
    o.max_time_step = step;
    FluidSolver s = solver(o);
    run(s, 0.4);
    std::size_t out = 0;
    for (const Vec3& x : s.particles().position) out += x.y() <= 0;
    const double layers =
        static_cast<double>(out) / static_cast<double>(emitter_layer(o.emitters[0], kSpacing).size());
    EXPECT_NEAR(layers, 0.7 * 0.4 / kSpacing, 1) << step;
  }
}

TEST(Emitter, StartsAndEndsInTime) {
  Emitter late = downward(0.05, 1);
  late.start = 0.1;
  late.end = 0.2;
  FluidOptions o = options(late);
  const std::vector<Vec3> one{Vec3(5, 0, 0)}, rest{Vec3::Zero()};
  FluidSolver s(o, one, rest, {});
  run(s, 0.099);
  EXPECT_EQ(s.size(), 1u);
  run(s, 0.4);
  EXPECT_EQ(s.size(), 1 + 5 * emitter_layer(late, kSpacing).size());  // 0.1 m of stream
  for (const Vec3& x : s.particles().position) EXPECT_LE(x.y(), 0) << "left in the nozzle";
}

TEST(Emitter, LimitIsKeptInWholeLayers) {
  Emitter e = downward(0.05, 1);
  const std::size_t layer = emitter_layer(e, kSpacing).size();
  e.max_particles = 4 * layer - 1;
  FluidSolver s = solver(options(e));
  run(s, 0.5);
  EXPECT_EQ(s.size(), 3 * layer);
}

// A particle that is pushed against the mouth does not enter: those that are led keep their velocity.
TEST(Emitter, HoldsItsStreamAgainstWhatIsInFront) {
  FluidOptions o = options(downward(0.06, 0.5));
  o.gravity = Vec3(0, 9.81, 0);  // back into the mouth
  FluidSolver s = solver(o);
  for (int k = 0; k < 60; ++k) {
    s.step(1);
    const Particles p = s.particles();
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.position[i].y() > 1e-4 && std::hypot(p.position[i].x(), p.position[i].z()) < 0.05) {
        EXPECT_LT((p.velocity[i] - Vec3(0, -0.5, 0)).norm(), 1e-6);
      }
  }
  EXPECT_GT(s.size(), 2 * emitter_layer(o.emitters[0], kSpacing).size());
}

TEST(Emitter, SecondFluidKeepsItsNumber) {
  Emitter e = downward(0.05, 1);
  e.fluid = 1;
  FluidOptions o = options(e);
  o.more_viscosities = {0.01};
  const std::vector<Vec3> one{Vec3(5, 0, 0)}, rest{Vec3::Zero()};
  FluidSolver s(o, one, rest, {});
  run(s, 0.1);
  const std::vector<std::uint8_t> fluid = s.fluids();
  EXPECT_EQ(fluid.front(), 0);
  for (std::size_t i = 1; i < fluid.size(); ++i) EXPECT_EQ(fluid[i], 1);
}

TEST(Emitter, SourcesStayWithTheParticlesAndAreSaved) {
  Emitter e = downward(0.05, 1);
  e.source = 7;
  const FluidOptions o = options(e);
  std::vector<Vec3> position, velocity;
  std::vector<int> source;
  for (const int block : {3, 1})  // the second is where cells come first, and both are so in turn
    for (int i = 0; i < 64; ++i) {
      position.push_back(kSpacing * Vec3(i % 4, i / 4 % 4 + 20, i / 16 + 10 * block));
      velocity.emplace_back(0, 0, 2 - block);
      source.push_back(block);
    }
  FluidSolver s(o, position, velocity, {}, {}, source);
  run(s, 0.1);
  std::vector<int> expected = source;
  ASSERT_GT(s.size(), expected.size());
  expected.resize(s.size(), 7);
  EXPECT_EQ(s.sources(), expected);

  std::stringstream state;
  StateWriter(state, little_endian())(s);
  FluidSolver other(o, position, velocity, {}, {}, std::vector<int>(position.size(), 9));
  StateReader archive(state);
  archive(other);
  EXPECT_EQ(other.sources(), expected);
  run(other, 0.15);
  expected.resize(other.size(), 7);
  EXPECT_EQ(other.sources(), expected);

  source.pop_back();
  EXPECT_THROW(FluidSolver(o, position, velocity, {}, {}, source), InvalidInput);
}

TEST(Emitter, SameBitsWithAnyNumberOfThreads) {
  const auto after = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FluidOptions o = options(downward(0.08, 1));
    o.gravity = Vec3(3, -9.81, 0);
    FluidSolver s = solver(o);
    for (int k = 0; k < 25; ++k) s.step(1);
    return s.particles();
  };
  const Particles one = after(1), many = after(4);
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one.position[i], many.position[i]) << i;
}

TEST(Emitter, MistakesAreRefused) {
  const auto refused = [](const auto& change) {
    Emitter e = downward(0.05, 1);
    change(e);
    EXPECT_THROW(check_emitter(e, kSpacing, 1), InvalidInput);
  };
  EXPECT_NO_THROW(check_emitter(downward(0.05, 1), kSpacing, 1));
  refused([](Emitter& e) { e.speed = 0; });
  refused([](Emitter& e) { e.direction.setZero(); });
  refused([](Emitter& e) { e.position.x() = std::nan(""); });
  refused([](Emitter& e) { e.mouth = DiscMouth{0.005}; });
  refused([](Emitter& e) { e.mouth = RectangleMouth{0.1, 0.1, Vec3(0, 1, 0)}; });  // up along the direction
  refused([](Emitter& e) { e.end = 0; });
  refused([](Emitter& e) { e.end = 0.005; });  // not one layer
  refused([](Emitter& e) { e.max_particles = 3; });
  refused([](Emitter& e) { e.fluid = 1; });
  Emitter late = downward(0.05, 1);
  late.start = 0.1;
  EXPECT_THROW(solver(options(late)), InvalidInput) << "nothing at the start";
}

}  // namespace
}  // namespace kappaflow
