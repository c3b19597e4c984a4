// Tension and pressure of thick liquid against theory.
#include "solver/viscous_pressure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solver/emitter.h"
#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

constexpr double kSpeed = 0.02;  // [m/s]

FluidOptions thick_liquid() {
  FluidOptions o;
  o.spacing = 1e-3;
  o.kinematic_viscosity = 0.05;
  return o;
}

/// What hangs from a mouth without inertia: liquid that left it at the time t0 carries the weight of what
/// came before, which is constant, with Trouton's viscosity 3 nu on a section that goes as one over its
/// stretch s.
///   3 nu s' / s = g kSpeed t0 s, so s = 1 / (1 - g kSpeed t0 (t - t0) / (3 nu)).
struct HangingThread {
  double viscosity, time;
  double weight(double born) const { return 9.81 * kSpeed * born / (3 * viscosity); }
  double stretch(double born) const { return 1 / (1 - weight(born) * (time - born)); }
  double below_mouth(double born) const {
    constexpr int kParts = 1000;
    const double part = (time - born) / kParts;
    double sum = 0;
    for (int k = 0; k < kParts; ++k) sum += kSpeed * stretch(born + (k + 0.5) * part) * part;
    return sum;
  }
};

TEST(ViscousPressure, HangingThreadIsDrawnOutAsTroutonSays) {
  FluidOptions o = thick_liquid();
  Emitter emitter;
  emitter.mouth = DiscMouth{4 * o.spacing};
  emitter.speed = kSpeed;
  o.emitters = {emitter};
  const std::size_t layer = emitter_layer(emitter, o.spacing).size();
  const double mouth = std::sqrt(static_cast<double>(layer) / std::numbers::pi) * o.spacing;
  const HangingThread exact{o.kinematic_viscosity, 1.3};
  FluidSolver solver(o, {}, {}, {});
  while (exact.time - solver.time() > 1e-9) solver.step(exact.time - solver.time());

  const Particles p = solver.particles();
  const std::vector<float> pressures = solver.pressures();
  double last = 0, thinnest = mouth;
  for (std::size_t k = solver.size() / layer - 4; k > 1; --k) {  // from the mouth down, without the bottom
    double height = 0, square = 0, pressure = 0;
    for (std::size_t i = k * layer; i < (k + 1) * layer; ++i) {
      height += p.position[i].y() / static_cast<double>(layer);
      square += Vec2(p.position[i].x(), p.position[i].z()).squaredNorm() / static_cast<double>(layer);
      pressure += static_cast<double>(pressures[i]) / static_cast<double>(layer);
    }
    const double born = (static_cast<double>(k) + 0.5) * o.spacing / kSpeed, radius = std::sqrt(2 * square);
    EXPECT_NEAR(-height, exact.below_mouth(born), 0.12 * exact.below_mouth(born) + 0.2 * o.spacing) << k;
    EXPECT_NEAR(radius, mouth / std::sqrt(exact.stretch(born)), 0.15 * mouth) << k;
    EXPECT_LT(pressure, 0) << k;
    if (last < 0) {
      EXPECT_LT(last - height, 3.5 * o.spacing) << "torn above layer " << k;
    }
    last = height;
    thinnest = std::min(thinnest, radius);
  }
  EXPECT_LT(thinnest, 0.8 * mouth);
}

// A ball that is drawn out by its own motion pulls at itself: it keeps its momentum and stays whole.
TEST(ViscousPressure, TensionKeepsMomentum) {
  FluidOptions o = thick_liquid();
  o.gravity.setZero();
  const std::vector<Vec3> points = test::blob(5e-3, o.spacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points)
    velocity.push_back(Vec3(1, 0.5, 0) + 100 * Vec3(-x.x() / 2, x.y(), -x.z() / 2));
  FluidSolver solver(o, points, velocity, {});
  const auto momenta = [](const Particles& p) {
    std::pair<Vec3, Vec3> sums(Vec3::Zero(), Vec3::Zero());
    for (std::size_t i = 0; i < p.size(); ++i) {
      sums.first += p.velocity[i];
      sums.second += p.position[i].cross(p.velocity[i]);
    }
    return sums;
  };
  const auto before = momenta(solver.particles());
  bool pulled = false;
  for (int k = 0; k < 20; ++k) {
    solver.step(1e3);
    for (const float pressure : solver.pressures()) pulled = pulled || pressure < 0;
  }
  const auto after = momenta(solver.particles());
  EXPECT_TRUE(pulled);
  EXPECT_LT((after.first - before.first).norm(), 1e-5 * before.first.norm());
  EXPECT_LT((after.second - before.second).norm(), 1e-4 * 5e-3 * before.first.norm());
}

// Three particles apart from the rest, driven from each other, have nothing to pull at. With tension they
// came together, and after some time lay in a point, at a pressure that shot them away.
TEST(ViscousPressure, LooseParticlesDoNotFallIntoAPoint) {
  FluidOptions o = thick_liquid();
  o.gravity.setZero();
  const double edge = 0.8 * o.spacing;
  const std::vector<Vec3> corners{{0, 0, 0}, {edge, 0, 0}, {edge / 2, std::sqrt(0.75) * edge, 0}};
  const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
  std::vector<Vec3> velocity;
  for (const Vec3& x : corners) velocity.push_back(100 * (x - middle));
  FluidSolver solver(o, corners, velocity, {});
  for (int k = 0; k < 40; ++k) solver.step(1e3);
  const Particles p = solver.particles();
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_GE((p.position[a] - p.position[(a + 1) % 3]).norm(), 0.999 * edge);
}

TEST(ViscousPressure, IsForThickLiquidAlone) {
  FluidOptions o = thick_liquid();
  EXPECT_TRUE(ViscousPressure(o).needed());
  o.kinematic_viscosity = 0.007;  // momentum crosses 5.9 spacings in a step
  EXPECT_FALSE(ViscousPressure(o).needed());
  o.more_viscosities = {0.05};
  EXPECT_TRUE(ViscousPressure(o).needed());
}

}  // namespace
}  // namespace kappaflow
