// Liquid from as thin as water to stiffer than rock, of any size: whole steps of the solver.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

constexpr double kGravity = 9.81;

/// A cube of 4 x 4 x 4 particles; times in units of sqrt(edge / g), speeds of sqrt(g edge).
struct Case {
  double viscosity, spacing;
  double edge() const { return 4 * spacing; }
  double speed() const { return std::sqrt(kGravity * edge()); }
  double time() const { return std::sqrt(edge() / kGravity); }
  /// Momentum does not cross a spacing in a unit of time.
  bool is_thin() const { return viscosity * time() < spacing * spacing; }
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.viscosity << " m2/s at " << c.spacing << " m";
}

struct Energy {
  double kinetic = 0, potential = 0;  // of a unit mass [m2/s2]
};

/// As seen from what moves at the velocity.
Energy energy(const FluidSolver& solver, const Vec3& from = Vec3::Zero()) {
  const Particles p = solver.particles();
  Energy sum;
  for (std::size_t i = 0; i < p.size(); ++i) {
    sum.kinetic += 0.5 * (p.velocity[i] - from).squaredNorm() / static_cast<double>(p.size());
    sum.potential += kGravity * p.position[i].y() / static_cast<double>(p.size());
  }
  return sum;
}

class Stiffness : public testing::TestWithParam<Case> {
 protected:
  FluidSolver cube(const Vec3& lower, const Vec3& velocity, const std::vector<SolidWall>& walls,
                   double slip = 0) const {
    const Case c = GetParam();
    FluidOptions o;
    o.spacing = c.spacing;
    o.kinematic_viscosity = c.viscosity;
    o.slip_length = slip;
    // Not much shorter than gravity asks for: what the pressure's tolerance leaves is a speed of spacing /
    // step.
    o.max_time_step = 0.03 * c.time();
    const auto points = test::block(lower, lower + Vec3::Constant(c.edge()), c.spacing);
    return {o, points, std::vector<Vec3>(points.size(), velocity), walls};
  }

  /// Runs for `duration`; the energy, seen from the walls, is never more than at the start, but for what
  /// moving apart compressed particles does. Returns the largest speed after `settled`, in units of sqrt(g
  /// edge).
  double run(FluidSolver& solver, double duration, double settled, const Vec3& walls = Vec3::Zero()) const {
    const Case c = GetParam();
    const Energy before = energy(solver, walls);
    const double start = before.kinetic + before.potential, unit = kGravity * c.edge();
    double fastest = 0;
    while (solver.time() < duration * c.time()) {
      const FluidStep step = solver.step(duration * c.time() - solver.time());
      EXPECT_LE(step.viscosity_error, 1) << solver.time();
      const Energy now = energy(solver, walls);
      EXPECT_LT(now.kinetic + now.potential, start + 0.05 * unit) << solver.time();
      if (solver.time() > settled * c.time()) fastest = std::max(fastest, step.fastest / c.speed());
      if (HasFailure()) break;
    }
    return fastest;
  }

  std::vector<SolidWall> scaled(std::vector<TriangleSurface> walls, const Vec3& shift = Vec3::Zero()) const {
    for (TriangleSurface& wall : walls)
      for (Vec3& x : wall.vertices) x = GetParam().edge() * (x + shift);
    return solid_walls(walls);
  }
};

// Thin liquid does not settle, see below.
TEST_P(Stiffness, RestsInAContainer) {
  if (GetParam().is_thin()) return;
  FluidSolver solver = cube(Vec3::Zero(), Vec3::Zero(), scaled(test::container(1, 1.5, 0.6)));
  EXPECT_LT(run(solver, 12, 8), 0.02);
}

// The lattice is not quite at rest between irregular walls, and what moves then is stopped by viscosity in
// spacing^2 / viscosity: hours in water of this size. Until then particles tremble with what a fall by two
// percent of a spacing gives, and nothing adds to that.
TEST_P(Stiffness, TremblesInAContainerNoMoreThanAtTheStart) {
  const Case c = GetParam();
  if (!c.is_thin()) return;
  FluidSolver solver = cube(Vec3::Zero(), Vec3::Zero(), scaled(test::container(1, 1.5, 0.6)));
  const auto largest_until = [&](double end) {
    double largest = 0;
    while (solver.time() < end * c.time()) {
      solver.step(end * c.time() - solver.time());
      largest = std::max(largest, energy(solver).kinetic);
    }
    return largest;
  };
  const double first = largest_until(6), then = largest_until(12);
  EXPECT_LT(first, 0.02 * kGravity * c.spacing);
  EXPECT_LT(then, first);
}

// Where creep would be slower than that. A stiff cube is set down unevenly by some hundredths of a spacing,
// and rocks: once in about 1.8 units of time, less and less.
TEST_P(Stiffness, RestsOnAFloor) {
  const Case c = GetParam();
  if (kGravity * c.edge() * c.edge() > 0.02 * c.speed() * c.viscosity) return;
  FluidSolver solver = cube(Vec3::Zero(), Vec3::Zero(), scaled({test::box_surface({-1, -1, -1}, {2, 0, 2})}));
  EXPECT_LT(run(solver, 12, 8), 0.02);
}

TEST_P(Stiffness, GainsNoEnergyWhereItIsDropped) {
  const Case c = GetParam();
  FluidSolver solver = cube(Vec3(0, 0.5 * c.edge(), 0), Vec3(0.3, -0.5, 0) * c.speed(),
                            scaled({test::box_surface({-3, -1, -3}, {4, 0, 4})}));
  run(solver, 3, 0);
}

TEST_P(Stiffness, GainsNoEnergyOnStairs) {
  const Case c = GetParam();
  FluidSolver solver = cube(Vec3(-0.6, 1.2, -0.5) * c.edge(), Vec3(0.8, 0, 0) * c.speed(),
                            scaled(test::stairs(4, 0.3, 0.6, 3)), 3 * c.edge());
  run(solver, 4, 0);
}

// A plate begins to move under the cube at its unit of speed. Seen from the plate, which then gives no
// energy, the cube comes sliding and may tip over; seen from outside, it may become faster than the plate.
TEST_P(Stiffness, GainsNoEnergyOnAWallThatDragsIt) {
  const Case c = GetParam();
  BodyMotion motion;
  motion.keys = {{0, Vec3(c.speed(), 0, 0), 0}};
  TriangleSurface plate = test::box_surface({-1, -1, -1}, {8, 0, 2});
  for (Vec3& x : plate.vertices) x *= c.edge();
  FluidSolver solver = cube(Vec3::Zero(), Vec3::Zero(), {SolidWall(plate, motion)});
  run(solver, 3, 0, Vec3(c.speed(), 0, 0));
}

INSTANTIATE_TEST_SUITE_P(, Stiffness, testing::Values(KAPPAFLOW_STIFFNESSES));

// Short steps, for they move particles along straight lines: a turning ball grows.
TEST(StiffBall, FallsAndTurnsAsARigidBody) {
  FluidOptions o;
  o.spacing = 0.1;
  o.kinematic_viscosity = 1e6;
  o.max_time_step = 4e-4;
  const Vec3 spin(0, 0, 20);
  const auto points = test::blob(0.2, o.spacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.push_back(spin.cross(x));
  FluidSolver solver(o, points, velocity, {});
  const auto angular = [&] {
    const Particles p = solver.particles();
    Vec3 x = Vec3::Zero(), v = Vec3::Zero(), sum = Vec3::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
      sum += p.position[i].cross(p.velocity[i]);
      x += p.position[i];
      v += p.velocity[i];
    }
    return Vec3(sum - x.cross(v) / static_cast<double>(p.size()));
  };
  const Vec3 before = angular();
  const double turns = 10, duration = turns * 2 * M_PI / spin.norm();
  while (solver.time() < duration) solver.step(duration - solver.time());
  EXPECT_LT((angular() - before).norm(), 1e-3 * before.norm());
  Vec3 mean = Vec3::Zero();
  const Particles p = solver.particles();
  for (const Vec3& v : p.velocity) mean += v / static_cast<double>(p.size());
  EXPECT_LT((mean - Vec3(0, -kGravity * duration, 0)).norm(), 1e-3 * kGravity * duration);
}

}  // namespace
}  // namespace kappaflow
