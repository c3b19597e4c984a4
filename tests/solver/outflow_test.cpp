#include "solver/outflow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"
#include "tests/solver/streams.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.05;

FluidOptions options() {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 0.01;
  o.gravity.setZero();
  return o;
}

/// A stream along x into a box, with a ball on its way that takes its middle.
FluidOptions stream() {
  FluidOptions o = options();
  test::add_stream(o);
  return o;
}

std::size_t sum(const std::vector<std::size_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

TEST(Outflow, RegionsHoldWhatTheirShapesSay) {
  const Outflow box{BoxShape{Vec3(0, 0, 0), Vec3(1, 2, 3)}}, ball{SphereShape{Vec3(1, 0, 0), 0.5}},
      bar{CylinderShape{Vec3(0, 0, 0), Vec3(2, 2, 0), 0.5}};
  EXPECT_TRUE(is_in(box, Vec3(1, 2, 3)));
  EXPECT_FALSE(is_in(box, Vec3(0.5, 1, 3.001)));
  EXPECT_TRUE(is_in(ball, Vec3(1.3, 0.3, 0.2)));
  EXPECT_FALSE(is_in(ball, Vec3(1.3, 0.3, 0.3)));
  EXPECT_TRUE(is_in(bar, Vec3(1, 1, 0.49)));
  EXPECT_FALSE(is_in(bar, Vec3(1, 1, 0.51)));
  EXPECT_TRUE(is_in(bar, Vec3(1.3, 0.65, 0)));
  EXPECT_FALSE(is_in(bar, Vec3(-0.01, -0.01, 0))) << "behind its end";
  EXPECT_FALSE(is_in(bar, Vec3(2.2, 1.9, 0)));
}

// A block that flies into the box: whole layers go when their centres come in.
TEST(Outflow, TakesWhatComesInAndCountsIt) {
  FluidOptions o = options();
  o.outflows = {{BoxShape{Vec3(0.5013, -1, -1), Vec3(2, 1, 1)}}, {SphereShape{Vec3(9, 9, 9), 1}}};
  const std::vector<Vec3> start = test::block(Vec3::Zero(), Vec3::Constant(0.4), kSpacing);
  ASSERT_EQ(start.size(), 512u);
  std::vector<int> source(start.size());
  std::iota(source.begin(), source.end(), 1000);
  FluidSolver s(o, start, std::vector<Vec3>(start.size(), Vec3::UnitX()), {}, {}, source);
  while (s.time() < 0.3) {
    s.step(0.3 - s.time());
    std::vector<std::int64_t> expected;
    for (std::size_t i = 0; i < start.size(); ++i)
      if (start[i].x() + s.time() < 0.5013) expected.push_back(static_cast<std::int64_t>(i));
    const Particles now = s.particles();
    ASSERT_EQ(now.id, expected) << s.time();
    ASSERT_EQ(s.taken(), (std::vector<std::size_t>{512 - expected.size(), 0}));
    ASSERT_EQ(s.sources().size(), expected.size());
    ASSERT_EQ(s.densities().size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(s.sources()[i], 1000 + expected[i]);
      ASSERT_LT((now.position[i] - start[expected[i]] - Vec3(s.time(), 0, 0)).norm(), 1e-4);
    }
  }
  EXPECT_EQ(s.taken()[0], 256u);
}

TEST(Outflow, LiquidMayBeTakenToTheLastParticle) {
  for (const double viscosity : {0.01, 100.0}) {
    FluidOptions o = options();
    o.kinematic_viscosity = viscosity;
    o.surface_tension = 0.01;
    o.gravity = Vec3(0, -9.81, 0);
    o.outflows = {{BoxShape{Vec3(-9, -9, -9), Vec3(9, -0.1, 9)}}};
    const std::vector<Vec3> start = test::block(Vec3::Zero(), Vec3::Constant(0.2), kSpacing);
    FluidSolver s(o, start, std::vector<Vec3>(start.size(), Vec3::Zero()), {});
    while (s.time() < 0.4) s.step(0.4 - s.time());
    EXPECT_EQ(s.size(), 0u);
    EXPECT_EQ(s.taken(), std::vector<std::size_t>{start.size()});
    EXPECT_EQ(s.particles().size(), 0u);
  }
}

// New particles get new ids, and what flows in is what is there or has gone.
TEST(Outflow, StreamIntoItKeepsItsLength) {
  FluidSolver s(stream(), {}, {}, {});
  std::size_t most = 0;
  while (s.time() < 1) {
    s.step(1 - s.time());
    most = std::max(most, s.size());
  }
  const std::size_t made = 36 * static_cast<std::size_t>(std::floor(2 * 1 / kSpacing + 2.5));
  EXPECT_EQ(s.size() + sum(s.taken()), made);
  EXPECT_LE(most, 36u * 13);
  const Particles now = s.particles();
  EXPECT_NO_THROW(check_particles(now)) << "ids ascend";
  EXPECT_EQ(now.id.back() + 1, static_cast<std::int64_t>(made));
  for (const int source : s.sources()) EXPECT_EQ(source, 4);
  EXPECT_GT(s.taken()[1], 50u) << "the ball takes nothing";
  EXPECT_GT(s.taken()[0], s.taken()[1]);
}

TEST(Outflow, SameBitsWithAnyNumberOfThreadsAndWhenReadBack) {
  const auto after = [](std::size_t threads, bool saved) {
    return test::after_steps(stream(), 60, threads, saved);
  };
  const auto one = after(1, false), many = after(4, false), resumed = after(2, true);
  EXPECT_GT(sum(one->taken()), 100u);
  for (const auto* other : {&many, &resumed}) {
    EXPECT_EQ((*other)->particles().id, one->particles().id);
    EXPECT_EQ((*other)->particles().position, one->particles().position);
    EXPECT_EQ((*other)->taken(), one->taken());
    EXPECT_EQ((*other)->sources(), one->sources());
  }
}

TEST(Outflow, MistakesAreRefused) {
  EXPECT_THROW(check_outflow({BoxShape{Vec3(0, 0, 0), Vec3(1, 0, 1)}}), InvalidInput);
  EXPECT_THROW(check_outflow({SphereShape{Vec3::Zero(), 0}}), InvalidInput);
  EXPECT_THROW(check_outflow({CylinderShape{Vec3::Zero(), Vec3::Zero(), 1}}), InvalidInput);
  FluidOptions o = stream();
  o.outflows.assign(256, o.outflows[0]);
  EXPECT_THROW(FluidSolver(o, {}, {}, {}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
