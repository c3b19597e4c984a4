#include "solver/fluid_solver.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numeric>

#include "core/errors.h"
#include "core/solid_distance.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::block;

FluidOptions options(double spacing) {
  FluidOptions o;
  o.spacing = spacing;
  return o;
}

std::vector<Vec3> uniform(std::size_t n, const Vec3& v) {
  return std::vector<Vec3>(n, v);
}

TEST(FluidSolver, FreeFallFollowsTheParabola) {
  FluidOptions o = options(0.1);
  const std::vector<Vec3> start = block({0, 0, 0}, {0.4, 0.4, 0.4}, 0.1);
  const Vec3 v0(0.5, 1, -0.2);
  FluidSolver solver(o, start, uniform(start.size(), v0), {});
  Vec3 moved = Vec3::Zero();  // by the scheme itself: symplectic Euler
  while (solver.time() < 0.5) {
    const double before = solver.time(), dt = solver.step(0.5 - before).time_step;
    moved += dt * (v0 + (before + dt) * o.gravity);
  }
  const double longest = o.max_time_step, t = 0.5;
  const Particles p = solver.particles();
  EXPECT_EQ(p.time, 0.5);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LT((p.velocity[i] - v0 - t * o.gravity).norm(), 1e-4);
    EXPECT_LT((p.position[i] - start[i] - moved).norm(), 2e-5);
    EXPECT_LT((p.position[i] - start[i] - t * v0 - 0.5 * t * t * o.gravity).norm(),
              0.5 * 9.81 * t * longest + 2e-5);
  }
}

TEST(FluidSolver, TranslationIsPreserved) {
  FluidOptions o = options(0.1);
  o.gravity.setZero();
  const std::vector<Vec3> start = test::blob(0.3, 0.11);  // below rest density: nothing to correct
  FluidSolver solver(o, start, uniform(start.size(), Vec3(2, -1, 0.5)), {});
  while (solver.time() < 0.2) solver.step(0.2 - solver.time());
  const Particles p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_LT((p.velocity[i] - Vec3(2, -1, 0.5)).norm(), 1e-5);
    EXPECT_LT((p.position[i] - start[i] - 0.2 * Vec3(2, -1, 0.5)).norm(), 1e-5);
  }
}

TEST(FluidSolver, FreeBlobConservesMomentum) {
  FluidOptions o = options(0.1);
  o.gravity.setZero();
  o.kinematic_viscosity = 0.1;
  const std::vector<Vec3> start = test::blob(0.4, 0.1);
  std::vector<Vec3> velocity;
  for (const Vec3& x : start)
    velocity.push_back(Vec3(1, 3, 2).cross(x) + Vec3(-x.x(), std::sin(9 * x.z()), 0.3));
  FluidSolver solver(o, start, velocity, {});
  const auto momenta = [&] {
    const Particles p = solver.particles();
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
      sum.head<3>() += p.velocity[i];
      sum.tail<3>() += p.position[i].cross(p.velocity[i]);
    }
    return sum;
  };
  const auto before = momenta();
  int iterations = 0;
  for (int k = 0; k < 40; ++k) iterations += solver.step(1).density_iterations;
  EXPECT_GT(iterations, 40);
  EXPECT_LT((momenta() - before).head<3>().norm(), 1e-5 * before.norm());
  EXPECT_LT((momenta() - before).tail<3>().norm(), 1e-5 * before.norm());
}

struct Column {
  static constexpr double kWidth = 0.4, kHeight = 0.5, kSpacing = 0.05;

  explicit Column(double viscosity) : solver(make(viscosity)) {}

  static FluidSolver make(double viscosity) {
    FluidOptions o = options(kSpacing);
    o.kinematic_viscosity = viscosity;
    o.slip_length = std::numeric_limits<double>::infinity();
    const auto points = block(Vec3::Zero(), {kWidth, kHeight, kWidth}, kSpacing);
    return FluidSolver(o, points, uniform(points.size(), Vec3(0, 0, 0)),
                       solid_walls(test::container(kWidth, 0.8, 0.2)));
  }

  double energy() const {  // per mass, kinetic and potential
    const Particles p = solver.particles();
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      sum += 0.5 * p.velocity[i].squaredNorm() + 9.81 * p.position[i].y();
    return sum / static_cast<double>(p.size());
  }

  FluidSolver solver;
};

// A container that speeds up, rises and turns takes its liquid along: after 0.6 s every particle is between
// its walls, and moves with it but for 0.05 m/s (RMS).
TEST(FluidSolver, AMovingContainerTakesItsLiquidAlong) {
  FluidOptions o = options(0.05);
  o.kinematic_viscosity = 1;
  const auto points = block(Vec3::Zero(), {0.3, 0.2, 0.3}, 0.05);
  const auto container = test::container(0.3, 0.4, 0.1);
  BodyMotion motion;
  motion.keys = {{0, Vec3::Zero(), 0}, {0.2, Vec3(1, 0.5, 0), 2}};
  motion.axis = Vec3::UnitY();
  motion.point = Vec3(0.15, 0, 0.15);
  FluidSolver solver(o, points, uniform(points.size(), Vec3(0, 0, 0)),
                     solid_walls(container, std::vector(container.size(), motion)));
  while (solver.time() < 0.6) solver.step(0.6 - solver.time());
  const Particles p = solver.particles();
  const RigidPose pose = motion.pose(0.6);
  double slip = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 x = pose.inverse(p.position[i]);
    EXPECT_GT(std::min({x.x(), x.y(), x.z()}), 0);
    EXPECT_LT(std::max(x.x(), x.z()), 0.3);
    slip += (p.velocity[i] - motion.velocity(0.6).at(p.position[i])).squaredNorm();
  }
  EXPECT_LT(std::sqrt(slip / static_cast<double>(p.size())), 0.05);
  EXPECT_THROW(solid_walls(container, std::vector{motion}), InvalidInput);
}

// Particles that start 2 percent too close are moved apart before the first step: they gain no speed by it,
// however short the steps are. With velocities it would be of the order 0.02 spacing / step, 2 m/s here.
TEST(FluidSolver, CrowdedParticlesSettleWithoutSpeed) {
  FluidOptions o = options(0.1);
  o.gravity.setZero();
  o.kinematic_viscosity = 0;
  o.max_time_step = 1e-3;
  const std::vector<Vec3> start = block(Vec3::Zero(), Vec3::Constant(0.784), 0.098);
  FluidSolver solver(o, start, uniform(start.size(), Vec3(0, 0, 0)), {});
  for (int k = 0; k < 20; ++k) EXPECT_LT(solver.step(1).fastest, 0.1);
  const Particles p = solver.particles();
  for (std::size_t i = 0; i < start.size(); ++i) EXPECT_LT((p.position[i] - start[i]).norm(), 0.02);
}

// The mean over half a second and over two layers against rho g depth; two, for neighbouring layers may
// differ by an alternating pressure that moves nothing. Particles next to a wall are left out: their pressure
// alone carries the contact.
TEST(FluidSolver, HydrostaticPressureGrowsWithDepth) {
  constexpr double kLayers = 0.1, kMargin = 1.5 * Column::kSpacing;
  Column column(0.5);
  while (column.solver.time() < 0.5) column.solver.step(0.5 - column.solver.time());
  std::vector<double> pressure(4, 0), expected(4, 0);
  while (column.solver.time() < 1) {
    const double dt = column.solver.step(1 - column.solver.time()).time_step;
    const Particles p = column.solver.particles();
    const std::vector<float> now = column.solver.pressures();
    double top = 0;
    for (const Vec3& x : p.position) top = std::max(top, x.y() + Column::kSpacing / 2);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3& x = p.position[i];
      if (std::min({x.x(), x.y(), x.z()}) < kMargin || std::max(x.x(), x.z()) > Column::kWidth - kMargin)
        continue;
      const auto layer = static_cast<std::size_t>((x.y() - kMargin) / kLayers);
      if (layer >= pressure.size()) continue;
      pressure[layer] += dt * static_cast<double>(now[i]);
      expected[layer] += dt * 1000 * 9.81 * (top - x.y());
    }
  }
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(pressure[k] / expected[k], 1, 0.06) << "layer " << k;
}

/// A column at rest with default options, stepped in frames of 0.04 s; pressures over that at its floor, rho
/// g depth, over 0.6 s after as long a wait. Particles next to a wall are left out, see above.
struct PressureAtRest {
  double worst = 0;        // deviation from 1 - y / depth of the mean over time and over two layers
  double fluctuation = 0;  // standard deviation over time of the mean over the column, over its mean
};

PressureAtRest pressure_at_rest(double depth, double spacing, double viscosity) {
  const double width = 8 * spacing, margin = 1.5 * spacing;
  FluidOptions o = options(spacing);
  o.kinematic_viscosity = viscosity;
  const auto points = block(Vec3::Zero(), {width, depth, width}, spacing);
  FluidSolver solver(o, points, uniform(points.size(), Vec3::Zero()),
                     solid_walls(test::container(width, depth + 0.2, 0.1)));
  std::vector<double> difference(static_cast<std::size_t>(depth / spacing)), weight(difference.size());
  double time = 0, sum = 0, square = 0;
  for (int frame = 1; frame <= 30; ++frame)
    while (0.04 * frame - solver.time() > 1e-12) {
      const double dt = solver.step(0.04 * frame - solver.time()).time_step;
      if (frame <= 15) continue;
      const Particles p = solver.particles();
      const std::vector<float> pressure = solver.pressures();
      double mean = 0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec3& x = p.position[i];
        const double now = static_cast<double>(pressure[i]) / (1000 * 9.81 * depth);
        mean += now / static_cast<double>(p.size());
        if (std::min({x.x(), x.y(), x.z()}) < margin || std::max(x.x(), x.z()) > width - margin) continue;
        const auto layers = static_cast<std::size_t>((x.y() - margin) / (2 * spacing));
        difference[layers] += dt * (now - (1 - x.y() / depth));
        weight[layers] += dt;
      }
      time += dt;
      sum += dt * mean;
      square += dt * mean * mean;
    }
  PressureAtRest result;
  for (std::size_t k = 0; k < weight.size(); ++k)
    if (weight[k] > 0) result.worst = std::max(result.worst, std::abs(difference[k] / weight[k]));
  result.fluctuation = std::sqrt(square / time - sum * sum / (time * time)) / (sum / time);
  return result;
}

TEST(FluidSolver, PressureOfColumnsAtRestIsRightAndSteadyWithDefaultOptions) {
  for (const auto& [depth, spacing] : {std::pair(0.25, 0.025), std::pair(1.0, 0.05)})
    for (const double viscosity : {0.1, 1e-6}) {
      const PressureAtRest p = pressure_at_rest(depth, spacing, viscosity);
      EXPECT_LT(p.worst, 0.05) << depth << " m deep, " << viscosity << " m2/s";
      EXPECT_LT(p.fluctuation, 0.05) << depth << " m deep, " << viscosity << " m2/s";
    }
  const PressureAtRest deepest = pressure_at_rest(2, 0.05, 0.1);
  EXPECT_LT(deepest.worst, 0.05);
  EXPECT_LT(deepest.fluctuation, 0.08);
}

// Thin liquid runs into a corner at 3 m/s and falls back, with default options: a step moves particles next
// to the walls by up to 0.4 spacings. What moves them apart again must not give them energy.
TEST(FluidSolver, ImpactSqueezesNoParticleByMoreThanFivePercent) {
  FluidOptions o = options(0.05);
  o.kinematic_viscosity = 1e-6;
  const auto points = block({0.4, 0, 0}, {0.8, 0.4, 0.3}, 0.05);
  FluidSolver solver(o, points, uniform(points.size(), Vec3(-3, 0, 0)),
                     solid_walls(std::vector{test::box_surface({-0.2, -0.2, -0.2}, {2, 0, 0.5}),
                                             test::box_surface({-0.2, -0.2, -0.2}, {0, 3, 0.5}),
                                             test::box_surface({-0.2, -0.2, -0.2}, {2, 3, 0}),
                                             test::box_surface({-0.2, -0.2, 0.3}, {2, 3, 0.5})}));
  const auto energy = [&] {  // per mass
    const Particles p = solver.particles();
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      sum += 0.5 * p.velocity[i].squaredNorm() + 9.81 * p.position[i].y();
    return sum / static_cast<double>(p.size());
  };
  double lowest = energy();
  while (solver.time() < 0.6) {
    ASSERT_LT(solver.step(0.6 - solver.time()).density_error_max, 0.05) << solver.time();
    ASSERT_LT(energy(), lowest + 0.05) << solver.time();
    lowest = std::min(lowest, energy());
  }
}

// Potential and kinetic energy, per mass: 0.01 J/kg lifts liquid by 1 mm, a fiftieth of the spacing.
TEST(FluidSolver, LiquidAtRestStaysAtRest) {
  for (const double viscosity : {1.0, 0.01}) {
    Column column(viscosity);
    const double start = column.energy();
    double settled = 0, fastest = 0;
    while (column.solver.time() < 1.5) {
      const FluidStep step = column.solver.step(1.5 - column.solver.time());
      EXPECT_LT(column.energy(), start + 0.02) << column.solver.time();
      EXPECT_LT(step.density_error_mean, 1e-3) << column.solver.time();
      if (column.solver.time() < 1) {
        settled = column.energy();
        continue;
      }
      EXPECT_LT(column.energy(), settled + 5e-3) << column.solver.time();
      fastest = std::max(fastest, step.fastest);
    }
    EXPECT_LT(fastest, viscosity == 1 ? 0.05 : 0.25);
    EXPECT_LT(column.energy(), start + 5e-3);
    for (const Vec3& x : column.solver.particles().position) {
      EXPECT_GT(std::min({x.x(), x.y(), x.z()}), 0);
      EXPECT_LT(std::max(x.x(), x.z()), Column::kWidth);
      EXPECT_LT(x.y(), Column::kHeight + 0.1 * Column::kSpacing);
    }
  }
}

TEST(FluidSolver, ResultHasTheSameBitsWithAnyNumberOfThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FluidOptions o = options(0.05);
    const auto points = block({-0.5, 0.4, -0.4}, {0.2, 0.8, 0.4}, 0.05);
    FluidSolver solver(o, points, uniform(points.size(), Vec3(1, 0, 0)),
                       solid_walls(test::stairs(2, 0.2, 0.5, 1)));
    for (int k = 0; k < 15; ++k) solver.step(1);
    return solver.particles();
  };
  const Particles one = run(1);
  for (const std::size_t threads : {2, 4}) {
    const Particles many = run(threads);
    EXPECT_EQ(one.time, many.time);
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one.position[i], many.position[i]) << threads << " threads, particle " << i;
      ASSERT_EQ(one.velocity[i], many.velocity[i]) << threads << " threads, particle " << i;
    }
  }
}

TEST(FluidSolver, StepsLandOnFrameTimes) {
  FluidOptions o = options(0.1);
  o.max_time_step = 3.1e-3;
  const auto points = block({0, 0, 0}, {0.2, 0.2, 0.2}, 0.1);
  FluidSolver solver(o, points, uniform(points.size(), Vec3::Zero()), {});
  for (int frame = 1; frame <= 30; ++frame) {
    const double end = frame / 30.0;
    while (solver.time() < end) {
      const FluidStep step = solver.step(end - solver.time());
      EXPECT_LE(step.time_step, o.max_time_step);
      EXPECT_GT(step.time_step,
                0.4 * o.max_time_step * std::min(1.0, 0.4 * 0.1 / (step.fastest * o.max_time_step)));
    }
    ASSERT_EQ(solver.time(), end);
  }
}

TEST(FluidSolver, NoStepMovesAParticleFurtherThanTheCflLength) {
  FluidOptions o = options(0.1);
  o.max_time_step = 1;
  const auto points = block({0, 0, 0}, {0.3, 0.3, 0.3}, 0.1);
  FluidSolver solver(o, points, uniform(points.size(), Vec3(0.3, 0, 0)), {});
  for (int k = 0; k < 20; ++k) {
    const Particles before = solver.particles();
    solver.step(10);
    const Particles after = solver.particles();
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((after.position[i] - before.position[i]).norm(), 1.001 * o.cfl * o.spacing);
  }
}

TEST(FluidSolver, ReportsWhatItsDensitiesSay) {
  FluidOptions o = options(0.05);
  const auto points = block({-0.5, 0.4, -0.3}, {0.0, 0.7, 0.3}, 0.05);
  FluidSolver solver(o, points, uniform(points.size(), Vec3::Zero()),
                     solid_walls(test::stairs(2, 0.2, 0.5, 1)));
  const FluidStep step = solver.step(0.1);
  double mean = 0, largest = 0;
  for (const float density : solver.densities()) {
    const double error = std::max(0.0, static_cast<double>(density) / 1000 - 1);
    mean += error / static_cast<double>(points.size());
    largest = std::max(largest, error);
  }
  EXPECT_NEAR(step.density_error_mean, mean, 1e-7);
  EXPECT_NEAR(step.density_error_max, largest, 1e-6);
}

TEST(FluidSolver, RejectsBadInput) {
  const std::vector<Vec3> points{Vec3(0, 1, 0)}, rest{Vec3::Zero()};
  const auto wall = solid_walls(std::vector{test::box_surface({-1, -1, -1}, {1, 0, 1})});
  EXPECT_NO_THROW(FluidSolver(options(0.1), points, rest, wall));
  EXPECT_THROW(FluidSolver(options(0), points, rest, wall), InvalidInput);
  EXPECT_THROW(FluidSolver(options(std::nan("")), points, rest, wall), InvalidInput);
  EXPECT_THROW(FluidSolver(options(0.1), {}, {}, wall), InvalidInput);
  EXPECT_THROW(FluidSolver(options(0.1), points, {}, wall), InvalidInput);
  EXPECT_THROW(FluidSolver(options(0.1), std::vector<Vec3>{Vec3(0, -0.5, 0)}, rest, wall), InvalidInput);
  EXPECT_THROW(FluidSolver(options(0.1), std::vector<Vec3>{Vec3(0, std::nan(""), 0)}, rest, wall),
               InvalidInput);
  FluidOptions o = options(0.1);
  o.min_time_step = 1;
  EXPECT_THROW(FluidSolver(o, points, rest, wall), InvalidInput);
  o = options(0.1);
  o.kinematic_viscosity = -1;
  EXPECT_THROW(FluidSolver(o, points, rest, wall), InvalidInput);
  FluidSolver solver(options(0.1), points, rest, wall);
  EXPECT_THROW(solver.step(0), InvalidInput);
  EXPECT_THROW(solver.step(std::nan("")), InvalidInput);
}

TEST(FluidSolver, FailureNamesTimeParticleAndSetting) {
  const std::vector<Vec3> points{Vec3(0, 1, 0), Vec3(3, 1, 0)}, velocity{Vec3::Zero(), Vec3(1e5, 0, 0)};
  FluidSolver solver(options(0.1), points, velocity, {});
  try {
    solver.step(1);
    FAIL() << "a step of 4e-7 s passed";
  } catch (const SolverFailure& failure) {
    const std::string message = failure.what();
    EXPECT_NE(message.find("t = 0 s, step 1, particle 1 at (3, 1, 0) m with 1e+05 m/s: "), std::string::npos)
        << message;
    EXPECT_NE(message.find("min_time_step"), std::string::npos) << message;
  }
}

TEST(FluidSolver, NotFiniteIsAFailure) {
  const std::vector<Vec3> points{Vec3(0, 1, 0)}, velocity{Vec3(1e38, 1e38, 0)};
  FluidSolver solver(options(0.1), points, velocity, {});
  try {
    solver.step(1);
    FAIL() << "a velocity of 1e38 m/s passed";
  } catch (const SolverFailure& failure) {
    const std::string message = failure.what();
    EXPECT_NE(message.find("step 1, particle 0 "), std::string::npos) << message;
    EXPECT_NE(message.find("its velocity is not finite; try a smaller cfl"), std::string::npos) << message;
  }
}

TEST(FluidSolver, MotionOfManySpacingsInAStepIsAFailure) {
  FluidOptions o = options(0.1);
  o.cfl = 100;
  const std::vector<Vec3> points{Vec3(0, 1, 0)}, velocity{Vec3(300, 0, 0)};
  FluidSolver solver(o, points, velocity, {});
  try {
    solver.step(1);
    FAIL() << "a step of fifteen spacings passed";
  } catch (const SolverFailure& failure) {
    const std::string message = failure.what();
    EXPECT_NE(message.find("the flow explodes: it would move by 15 spacings in one step"), std::string::npos)
        << message;
  }
}

TEST(FluidSolver, PressureThatDoesNotConvergeIsAFailure) {
  // Nothing drives particles apart that all are in one place.
  const std::vector<Vec3> points(20, Vec3(0.5, 0.3, 0.5));
  FluidSolver solver(options(0.1), points, uniform(points.size(), Vec3::Zero()), {});
  EXPECT_THROW(solver.step(0.1), SolverFailure);
}

TEST(FluidSolver, SurvivesCoincidentAndLostParticles) {
  FluidOptions o = options(0.1);
  std::vector<Vec3> points(3, Vec3(0.5, 0.3, 0.5));
  points.emplace_back(1e4, -1e4, 0);
  FluidSolver solver(o, points, uniform(points.size(), Vec3::Zero()), {});
  for (int k = 0; k < 10; ++k) solver.step(0.1);
  for (const Vec3& x : solver.particles().position) EXPECT_TRUE(x.allFinite());
}

}  // namespace
}  // namespace kappaflow
