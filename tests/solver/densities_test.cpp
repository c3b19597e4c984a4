// Liquids of different density.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <sstream>

#include "core/errors.h"
#include "core/saved_state.h"
#include "solver/fluid_solver.h"
#include "solver/pressure.h"
#include "solver/surface_tension.h"
#include "solver/viscosity.h"
#include "solver/viscous_pressure.h"
#include "tests/dense.h"
#include "tests/solver/dense_system.h"
#include "tests/solver/shapes.h"
#include "tests/solver/streams.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr double kSpacing = 0.1;
constexpr float kTimeStep = 4e-3f;

FluidOptions options(double viscosity, double other_density) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = viscosity;
  o.more_viscosities = {2 * viscosity};
  o.more_densities = {other_density};
  o.density_tolerance = o.divergence_tolerance = 1e-6;
  o.max_pressure_iterations = 2000;
  return o;
}

/// A blob in turmoil whose lower half is of fluid 0, the upper of fluid 1.
Liquid two_liquids(const FluidOptions& o, double compressed = 1) {
  const auto points = test::blob(0.3, compressed * kSpacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points)
    velocity.push_back(-2 * x + Vec3(std::sin(7 * x.y()) + 1, std::cos(9 * x.z()), std::sin(8 * x.x())));
  Liquid liquid(points, velocity, static_cast<float>(kSpacing));
  for (std::size_t i = 0; i < points.size(); ++i)
    liquid.particles.fluid[i] = liquid.particles.position[i].y() > 0;
  liquid.particles.mass_of_fluid = masses_of_fluids(o);
  liquid.update();
  return liquid;
}

/// Linear and angular, over the mass of a particle of fluid 0.
Eigen::Matrix<double, 6, 1> momenta(const FluidParticles& particles) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3 x = particles.position[i].head<3>().cast<double>(),
               p = static_cast<double>(particles.mass(i)) * particles.velocity[i].head<3>().cast<double>();
    sum.head<3>() += p;
    sum.tail<3>() += x.cross(p);
  }
  return sum;
}

/// What all the changes of momentum since `before` would be, had they one direction.
double impulse(const FluidParticles& particles, const std::vector<Vec4f>& before) {
  double sum = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    sum += static_cast<double>(particles.mass(i) * (particles.velocity[i] - before[i]).norm());
  return sum;
}

TEST(Densities, EveryForceKeepsMomentum) {
  FluidOptions o = options(1, 30);
  o.surface_tension = 5;
  Liquid liquid = two_liquids(o, 0.95);
  PressureSolver pressure(o);
  const auto expect_kept = [&](const char* force, const auto& act) {
    const auto before = momenta(liquid.particles);
    const std::vector<Vec4f> velocity = liquid.particles.velocity;
    act();
    const double whole = impulse(liquid.particles, velocity);
    EXPECT_GT(whole, 1e-3) << force << ": nothing happened";
    EXPECT_LT((momenta(liquid.particles) - before).norm(), 1e-5 * std::max(whole, before.norm())) << force;
  };
  expect_kept("tension", [&] { SurfaceTension(o).apply(liquid.particles, liquid.lists, kTimeStep); });
  expect_kept("viscosity",
              [&] { ViscositySolver(o).solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep); });
  expect_kept("density",
              [&] { pressure.correct_density(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep); });
  liquid = two_liquids(o, 0.95);
  expect_kept("divergence", [&] {
    pressure.correct_divergence(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  });
  std::ranges::fill(liquid.particles.least_pressure, -50.0f);
  expect_kept("spreading", [&] { ViscousPressure(o).spread(liquid.particles, liquid.lists, kTimeStep); });
}

TEST(Densities, ViscosityIsThatOfADenseSolver) {
  FluidOptions o = options(1, 50);
  o.viscosity_tolerance = 1e-5;
  o.max_viscosity_iterations = 500;
  Liquid liquid = two_liquids(o);
  ViscositySolver solver(o);
  const Eigen::MatrixXd matrix = test::dense_system(liquid, kTimeStep, solver);
  EXPECT_LT((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-5 * matrix.cwiseAbs().maxCoeff());
  // The liquid's inertia is what the matrix takes from a common motion.
  Eigen::VectorXd common = Eigen::VectorXd::Zero(matrix.rows()),
                  weighted = test::stacked(liquid.particles.velocity);
  double mass = 0;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const double m = liquid.particles.position[i].y() > 0 ? 0.05 : 1;
    mass += m;
    common[3 * static_cast<Eigen::Index>(i)] = 1;
    weighted.segment<3>(3 * static_cast<Eigen::Index>(i)) *= m;
  }
  EXPECT_NEAR(common.dot(matrix * common), mass, 1e-4 * mass);
  const Eigen::VectorXd expected = testing::least_squares(matrix, weighted);
  EXPECT_GT(solver.solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep).iterations, 3);
  EXPECT_LT((test::stacked(liquid.particles.velocity) - expected).norm(), 1e-4 * expected.norm());
}

// The kinematic viscosities are equal, so that the shear rates must be inverse to the densities.
TEST(Densities, ShearStressIsContinuous) {
  FluidOptions o = options(1, 100);
  o.more_viscosities = {1};
  const auto points = test::block({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, kSpacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(x.y() > 0 ? x.y() / 0.1 : x.y(), 0, 0);
  Liquid liquid(points, velocity, static_cast<float>(kSpacing));
  for (std::size_t i = 0; i < points.size(); ++i)
    liquid.particles.fluid[i] = liquid.particles.position[i].y() > 0;
  liquid.particles.mass_of_fluid = masses_of_fluids(o);
  std::vector<Vec4f> image;
  ViscositySolver(o).apply(liquid.particles, liquid.lists, liquid.wall_sums, 1, liquid.particles.velocity,
                           image);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (liquid.particles.position[i].head<3>().cwiseAbs().maxCoeff() > 0.26f) continue;
    const float own = liquid.particles.mass(i) * liquid.particles.velocity[i][0];
    EXPECT_NEAR(image[i][0] - own, 0, 5) << liquid.particles.position[i].transpose();
  }
}

TEST(Densities, PressureSystemIsSymmetricWithItsDiagonal) {
  Liquid liquid = two_liquids(options(1, 40));
  const std::size_t n = liquid.particles.size();
  Eigen::MatrixXd matrix(n, n);
  std::vector<Vec4f> acceleration(n);
  for (std::size_t column = 0; column < n; ++column) {
    for (std::size_t i = 0; i < n; ++i) liquid.particles.position[i][3] = i == column;
    for (std::size_t i = 0; i < n; ++i)
      acceleration[i] = pressure_acceleration(i, liquid.particles, liquid.lists);
    for (std::size_t i = 0; i < n; ++i)
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) =
          -static_cast<double>(density_rate(i, liquid.particles, liquid.lists, acceleration));
  }
  EXPECT_LT((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-5 * matrix.cwiseAbs().maxCoeff());
  for (std::size_t i = 0; i < n; ++i) {
    const FluidParticles& p = liquid.particles;
    const double diagonal =
        static_cast<double>(p.gradient_sum[i].squaredNorm() / p.mass(i) + p.gradient_square_sum[i]);
    EXPECT_NEAR(matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)), diagonal,
                1e-4 * diagonal);
  }
}

/// Liquid without viscosity or friction at rest in a container, with a ball of another density in its middle.
struct BallInATank {
  static constexpr double kRadius = 0.4, kWidth = 2;
  explicit BallInATank(double ball_density) {
    FluidOptions o = options(0, ball_density);
    o.slip_length = std::numeric_limits<double>::infinity();
    const auto points = test::block(Vec3::Zero(), Vec3::Constant(kWidth), kSpacing);
    for (const Vec3& x : points) fluid.push_back((x - Vec3::Constant(kWidth / 2)).norm() < kRadius);
    solver.emplace(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                   solid_walls(test::container(kWidth, 1.5 * kWidth, 0.3)), fluid);
  }
  /// Mean upward velocity of the ball [m/s].
  double speed() const {
    double sum = 0;
    const Particles p = solver->particles();
    for (std::size_t i = 0; i < p.size(); ++i) sum += fluid[i] ? p.velocity[i].y() : 0;
    return sum / static_cast<double>(std::ranges::count(fluid, 1));
  }
  std::vector<std::uint8_t> fluid;
  std::optional<FluidSolver> solver;
};

// A ball of the density r in liquid of the density 1 begins to move with g (1 - r) / (r + 1/2), for it takes
// half its volume of that along (Lamb, "Hydrodynamics", 92). Walls five radii apart hinder that by a few
// percent.
TEST(Densities, BuoyancyMovesABallAndWhatItTakesAlong) {
  for (const double r : {0.05, 0.5, 100.0}) {
    BallInATank ball(1000 * r);
    double time = 0;
    while (time < 0.0099) time += ball.solver->step(0.01 - time).time_step;
    const double known = 9.81 * (1 - r) / (r + 0.5);
    EXPECT_NEAR(ball.speed() / time, known, 0.1 * std::abs(known)) << r;
  }
}

/// A column of liquid of which the upper half has the density `above`, the lower one 1000 kg/m3.
struct Layers {
  explicit Layers(double above) {
    FluidOptions o = options(0.05, above);
    o.more_viscosities = {0.05};
    o.density_tolerance = 1e-5;
    const auto points = test::block(Vec3::Zero(), Vec3::Ones(), kSpacing);
    for (const Vec3& x : points) fluid.push_back(x.y() > 0.5);
    FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                       solid_walls(test::container(1, 1.5, 0.2)), fluid);
    int steps = 0;
    for (; solver.time() < 0.8; solver.step(0.8 - solver.time())) {
      if (solver.time() < 0.4) continue;
      height = solver.particles().position;
      const std::vector<float> pressure = solver.pressures();
      bottom += mean_at(0.05, pressure);
      middle += mean_at(0.75, pressure);
      ++steps;
    }
    bottom /= steps, middle /= steps;
    density = solver.densities();
  }
  double mean_at(double y, const std::vector<float>& values) const {
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::abs(height[i].y() - y) < kSpacing / 2) sum += static_cast<double>(values[i]), ++count;
    return sum / count;
  }
  std::vector<std::uint8_t> fluid;
  std::vector<Vec3> height;
  std::vector<float> density;     // [kg/m3]
  double bottom = 0, middle = 0;  // mean pressure at the floor, and in the middle of the upper half [Pa]
};

// Light liquid above heavy liquid stays there, and what lies above bears on what lies below, in the
// proportions of the densities.
TEST(Densities, LayersRestAndTheirWeightsAddUp) {
  const Layers even(1000);
  for (const double r : {0.1, 0.5}) {
    const Layers layers(1000 * r);
    EXPECT_NEAR(layers.bottom / even.bottom, (0.45 + 0.5 * r) / 0.95, 0.03) << r;
    EXPECT_NEAR(layers.middle / even.middle, r, 0.05 * r) << r;
    for (std::size_t i = 0; i < layers.fluid.size(); ++i) {
      const bool upper = layers.fluid[i] != 0;
      EXPECT_EQ(layers.height[i].y() > (upper ? 0.46 : 0.54), upper) << layers.height[i].transpose();
    }
    EXPECT_NEAR(layers.mean_at(0.75, layers.density), 1000 * r, 30 * r);
    EXPECT_NEAR(layers.mean_at(0.25, layers.density), 1000, 30);
  }
}

TEST(Densities, HeatWarmsByTheLiquidsOwnDensity) {
  FluidOptions o = options(1e3, 250);
  o.gravity.setZero();
  o.max_time_step = 2;
  o.heat = HeatOptions{.temperature = 300, .fluids = {{1000, 0}, {1000, 0}}};
  o.heat->fluids[0].conductivity = o.heat->fluids[1].conductivity = 1e4;
  const auto points = test::block(Vec3::Zero(), Vec3::Constant(0.6), kSpacing);
  std::vector<std::uint8_t> fluid;
  std::vector<double> temperature;
  for (const Vec3& x : points) {
    fluid.push_back(x.y() > 0.3);
    temperature.push_back(fluid.back() ? 400 : 300);
  }
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()), {}, fluid, {}, temperature);
  while (solver.time() < 100) solver.step(100 - solver.time());
  // 300 K of four parts of the heat capacity, 400 K of one.
  for (const double t : solver.temperatures()) EXPECT_NEAR(t, 320, 0.05);
}

/// Two liquids and a third that flows in, of which one yields, with a body that is lighter than two of them.
FluidSolver everything_at_once() {
  FluidOptions o = options(0.5, 100);
  o.more_viscosities = {0.5, 0.5};
  o.more_densities = {100, 3000};
  o.rheologies = {{}, HerschelBulkley{.yield_stress = 0.01, .consistency = 0.1}};
  o.density_tolerance = 1e-4, o.divergence_tolerance = 1e-3;
  o.surface_tension = 1;
  Emitter emitter = test::downward(0.1, 1);
  emitter.position = Vec3(0.85, 1.6, 0.85);
  emitter.fluid = 2;
  o.emitters = {emitter};
  const RigidBody body{SolidWall(test::box_surface({0.3, 1.0, 0.3}, {0.7, 1.3, 0.7})), 500 * 0.4 * 0.4 * 0.3};
  const auto points = test::block(Vec3::Zero(), {1, 0.9, 1}, kSpacing);
  std::vector<std::uint8_t> fluid;
  for (const Vec3& x : points) fluid.push_back(x.y() > 0.5);
  return {o,
          points,
          std::vector<Vec3>(points.size(), Vec3::Zero()),
          solid_walls(test::container(1, 1.8, 0.2)),
          fluid,
          {},
          {},
          {&body, 1}};
}

TEST(Densities, SameBitsWithAnyNumberOfThreadsAndAfterAStop) {
  const auto run = [](std::size_t threads, bool stop) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FluidSolver solver = everything_at_once();
    for (int k = 0; k < 20; ++k) solver.step(1);
    if (stop) {
      std::stringstream state;
      StateWriter(state, little_endian())(solver);
      solver = everything_at_once();
      StateReader archive(state);
      archive(solver);
    }
    for (int k = 0; k < 20; ++k) solver.step(1);
    return solver.particles();
  };
  const Particles one = run(1, false);
  for (const Particles& other : {run(4, false), run(2, true)}) {
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one.position[i], other.position[i]) << i;
      ASSERT_EQ(one.velocity[i], other.velocity[i]) << i;
    }
  }
}

TEST(Densities, MistakesAreRefused) {
  const std::vector<Vec3> points{Vec3::Zero()};
  FluidOptions o = options(1, 1);
  EXPECT_THROW(FluidSolver(o, points, points, {}), InvalidInput) << "1000 times lighter";
  o.more_densities = {-1};
  EXPECT_THROW(FluidSolver(o, points, points, {}), InvalidInput);
  o.more_densities = {500, 500};
  EXPECT_THROW(FluidSolver(o, points, points, {}), InvalidInput) << "there are two fluids";
  o.more_densities = {1e5};
  EXPECT_NO_THROW(FluidSolver(o, points, points, {}));
}

}  // namespace
}  // namespace kappaflow
