#include "solver/pressure.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tests/dense.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f;
constexpr float kTimeStep = 4e-3f;

FluidOptions options(double tolerance) {
  FluidOptions o;
  o.spacing = static_cast<double>(kSpacing);
  o.density_tolerance = o.divergence_tolerance = tolerance;
  o.max_pressure_iterations = 2000;
  return o;
}

std::vector<WallSample> wall_below() {
  std::vector<WallSample> wall;
  for (double x = -0.6; x < 0.6; x += 0.07)
    for (double z = -0.6; z < 0.6; z += 0.07) wall.push_back({Vec3(x, -0.37, z), Vec3::UnitY()});
  return wall;
}

/// A blob that falls together, on a wall.
Liquid collapsing() {
  const auto points = test::blob(0.3, 0.95 * static_cast<double>(kSpacing));
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(-2 * x + Vec3(0, -1, 0.3 * std::sin(20 * x.x())));
  return Liquid(points, velocity, kSpacing, wall_below());
}

PressureSolve correct_density(Liquid& liquid, PressureSolver& solver) {
  solver.apply_last(liquid.particles, liquid.lists, kTimeStep);
  return solver.correct_density(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
}

TEST(Pressure, DensityRateMatchesFiniteDifferences) {
  Liquid liquid = collapsing();
  const float step = 1e-3f;
  std::vector<float> rate(liquid.particles.size()), before(rate.size()), after(rate.size());
  for (std::size_t i = 0; i < rate.size(); ++i) {
    rate[liquid.particles.id[i]] = density_rate(i, liquid.particles, liquid.lists, liquid.particles.velocity);
  }
  const auto moved_density = [&](float dt, std::vector<float>& density) {
    Liquid moved = liquid;
    for (std::size_t i = 0; i < rate.size(); ++i)
      moved.particles.position[i] += dt * moved.particles.velocity[i];
    moved.update();
    for (std::size_t i = 0; i < rate.size(); ++i) density[moved.particles.id[i]] = moved.particles.density[i];
  };
  moved_density(step, after);
  moved_density(-step, before);
  for (std::size_t i = 0; i < rate.size(); ++i)
    EXPECT_NEAR(rate[i], (after[i] - before[i]) / (2 * step), 0.01) << "rates reach 6 1/s";
}

// D D^T through the solver's own two functions.
TEST(Pressure, SystemIsSymmetricAndPositiveSemidefinite) {
  Liquid liquid = collapsing();
  const std::size_t n = liquid.particles.size();
  Eigen::MatrixXd matrix(n, n);
  for (std::size_t column = 0; column < n; ++column) {
    for (std::size_t i = 0; i < n; ++i) liquid.particles.position[i][3] = i == column;
    std::vector<Vec4f> acceleration(n);
    for (std::size_t i = 0; i < n; ++i)
      acceleration[i] = pressure_acceleration(i, liquid.particles, liquid.lists);
    for (std::size_t i = 0; i < n; ++i)
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) =
          -static_cast<double>(density_rate(i, liquid.particles, liquid.lists, acceleration));
  }
  const double largest = matrix.cwiseAbs().maxCoeff();
  EXPECT_LT((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-5 * largest);
  const Eigen::VectorXd eigenvalues = testing::eigenvalues(matrix);
  EXPECT_GT(eigenvalues.minCoeff(), -1e-5 * eigenvalues.maxCoeff());
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_NEAR(matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)),
                static_cast<double>(liquid.particles.gradient_sum[i].squaredNorm() +
                                    liquid.particles.gradient_square_sum[i]),
                1e-4 * largest);
}

TEST(Pressure, DensitySolveEndsAtTheComplementaryPoint) {
  Liquid liquid = collapsing();
  PressureSolver solver(options(1e-6));
  const PressureSolve done = correct_density(liquid, solver);
  EXPECT_LT(done.mean_error, 1e-6);
  EXPECT_LT(done.iterations, 500);
  std::size_t pressed = 0;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const float kappa = liquid.particles.density_pressure[i];
    const float predicted =
        liquid.particles.density[i] - 1 +
        kTimeStep * density_rate(i, liquid.particles, liquid.lists, liquid.particles.velocity);
    EXPECT_GE(kappa, 0);
    EXPECT_LT(predicted, 2e-4);
    if (kappa > 1) {
      EXPECT_GT(predicted, -2e-4) << "held below rest density by a pressure";
    }
    pressed += kappa > 1;
  }
  EXPECT_GT(pressed, liquid.particles.size() / 3);
}

TEST(Pressure, DivergenceSolveStopsCompressionOfDenseLiquidOnly) {
  Liquid liquid = collapsing();
  PressureSolver solver(options(1e-6));
  solver.correct_divergence(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
    const float rate = kTimeStep * density_rate(i, liquid.particles, liquid.lists, liquid.particles.velocity);
    EXPECT_LT(rate, std::max(0.0f, 1 - liquid.particles.density[i]) + 2e-4f);
  }
}

TEST(Pressure, ConvergedStartNeedsNoFurtherIterations) {
  Liquid liquid = collapsing();
  PressureSolver solver(options(1e-4));
  const std::vector<Vec4f> velocity = liquid.particles.velocity;
  const int first = correct_density(liquid, solver).iterations;
  liquid.particles.velocity = velocity;
  EXPECT_GT(first, 5);
  EXPECT_LE(correct_density(liquid, solver).iterations, 1);
}

// Half the pressure everywhere is the error that sweeps are slowest at; as a whole it is seen at once.
TEST(Pressure, HalfThePressureStartsAsWellAsAllOfIt) {
  Liquid liquid = collapsing();
  PressureSolver solver(options(1e-5));
  const std::vector<Vec4f> velocity = liquid.particles.velocity;
  EXPECT_GT(correct_density(liquid, solver).iterations, 20);
  const std::vector<float> pressure = liquid.particles.density_pressure;
  liquid.particles.velocity = velocity;
  for (float& kappa : liquid.particles.density_pressure) kappa *= 0.5f;
  EXPECT_LE(correct_density(liquid, solver).iterations, 1);
  const float largest = *std::ranges::max_element(pressure);
  for (std::size_t i = 0; i < pressure.size(); ++i)
    EXPECT_NEAR(liquid.particles.density_pressure[i], pressure[i], 0.01f * largest);
}

TEST(Pressure, MoveApartTakesPlacesNotVelocities) {
  const auto points = test::blob(0.35, 0.9 * static_cast<double>(kSpacing));
  Liquid liquid(points, std::vector<Vec3>(points.size(), Vec3(1, 2, 3)), kSpacing);
  EXPECT_GT(*std::ranges::max_element(liquid.particles.density), 1.3f);
  PressureSolver solver(options(1e-4));
  for (int round = 0; round < 3; ++round) {
    solver.move_apart(liquid.particles, liquid.lists, 1e-4);
    liquid.update();
  }
  EXPECT_LT(*std::ranges::max_element(liquid.particles.density), 1.02f);
  Vec3 before = Vec3::Zero(), after = Vec3::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    before += points[i] / static_cast<double>(points.size());
    after += liquid.particles.position[i].head<3>().cast<double>() / static_cast<double>(points.size());
    EXPECT_EQ(liquid.particles.velocity[i], Vec4f(1, 2, 3, 0));
    EXPECT_EQ(liquid.particles.density_pressure[i], 0);
  }
  EXPECT_LT((after - before).norm(), 1e-5 * static_cast<double>(kSpacing));
}

TEST(Pressure, ConservesLinearAndAngularMomentum) {
  const auto points = test::blob(0.35, 0.9 * static_cast<double>(kSpacing));
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.push_back(Vec3(0.2, -0.1, 0.3).cross(x) + Vec3(1, 2, 3));
  Liquid liquid(points, velocity, kSpacing);
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      const Vec3 v = liquid.particles.velocity[i].head<3>().cast<double>();
      sum.head<3>() += v;
      sum.tail<3>() += Vec3(liquid.particles.position[i].head<3>().cast<double>()).cross(v);
    }
    return sum;
  };
  const auto before = momenta();
  const std::vector<Vec4f> start = liquid.particles.velocity;
  PressureSolver solver(options(1e-2));
  correct_density(liquid, solver);
  double impulse = 0;
  for (std::size_t i = 0; i < start.size(); ++i)
    impulse += static_cast<double>((liquid.particles.velocity[i] - start[i]).norm());
  EXPECT_GT(impulse, 100);
  EXPECT_LT((momenta() - before).norm(), 1e-6 * impulse);
}

TEST(Pressure, LoneParticlesFeelNone) {
  const std::vector<Vec3> points{Vec3(0, 0, 0), Vec3(5, 0, 0)};
  Liquid liquid(points, {Vec3(1, 2, 3), Vec3(-1, 0, 0)}, kSpacing);
  PressureSolver solver(options(1e-4));
  correct_density(liquid, solver);
  solver.correct_divergence(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_EQ(liquid.particles.velocity[i],
              liquid.particles.id[i] == 0 ? Vec4f(1, 2, 3, 0) : Vec4f(-1, 0, 0, 0));
}

}  // namespace
}  // namespace kappaflow
