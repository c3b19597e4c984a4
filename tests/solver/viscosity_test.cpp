#include "solver/viscosity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <random>

#include "tests/dense.h"
#include "tests/solver/dense_system.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f;
constexpr float kTimeStep = 4e-3f;

FluidOptions options(double viscosity, double tolerance) {
  FluidOptions o;
  o.spacing = static_cast<double>(kSpacing);
  o.kinematic_viscosity = viscosity;
  o.slip_length = 0.05;
  o.viscosity_tolerance = tolerance;
  o.max_viscosity_iterations = 500;
  return o;
}

std::vector<Vec3> swirling(const std::vector<Vec3>& points) {
  std::vector<Vec3> velocity;
  for (const Vec3& x : points)
    velocity.emplace_back(std::sin(7 * x.y()) + 1, std::cos(9 * x.z() + x.x()), std::sin(8 * x.x() * x.y()));
  return velocity;
}

Liquid blob_near_wall() {
  const auto points = test::blob(0.25, static_cast<double>(kSpacing));
  std::vector<WallSample> wall;
  for (double x = -0.4; x < 0.4; x += 0.08)
    for (double z = -0.4; z < 0.4; z += 0.08) wall.push_back({Vec3(x, -0.33, z), Vec3::UnitY()});
  return Liquid(points, swirling(points), kSpacing, wall);
}

TEST(Viscosity, SystemIsSymmetricAndPositiveDefinite) {
  const Liquid liquid = blob_near_wall();
  const Eigen::MatrixXd matrix = test::dense_system(liquid, kTimeStep, ViscositySolver(options(1, 1e-3)));
  EXPECT_LT((matrix - matrix.transpose()).cwiseAbs().maxCoeff(), 1e-5 * matrix.cwiseAbs().maxCoeff());
  const Eigen::VectorXd eigenvalues = testing::eigenvalues(matrix);
  EXPECT_GT(eigenvalues.minCoeff(), 1 - 1e-4);
  EXPECT_GT(eigenvalues.maxCoeff(), 5);  // else the next test would be too easy
}

TEST(Viscosity, SolvesTheSystemAsADenseSolver) {
  Liquid liquid = blob_near_wall();
  ViscositySolver solver(options(1, 1e-5));
  const Eigen::VectorXd expected = testing::least_squares(test::dense_system(liquid, kTimeStep, solver),
                                                          test::stacked(liquid.particles.velocity));
  const int iterations = solver.solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep).iterations;
  EXPECT_GT(iterations, 3);
  EXPECT_LT((test::stacked(liquid.particles.velocity) - expected).norm(), 1e-4 * expected.norm());
}

// What gravity adds in a step is the scale: the liquid's speeds and their change are larger.
TEST(Viscosity, ErrorFollowsTheTolerance) {
  Liquid start = blob_near_wall();
  const Eigen::VectorXd before = test::stacked(start.particles.velocity);
  const Eigen::VectorXd exact =
      testing::least_squares(test::dense_system(start, kTimeStep, ViscositySolver(options(1, 1))), before);
  const double n = static_cast<double>(start.particles.size());
  const double scale = 9.81 * static_cast<double>(kTimeStep) * std::sqrt(n);
  ASSERT_GT((before - exact).norm(), scale);
  for (const double tolerance : {1e0, 1e-1, 1e-2, 1e-3, 1e-4}) {
    Liquid liquid = start;
    const ViscositySolve solve = ViscositySolver(options(1, tolerance))
                                     .solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
    EXPECT_LE(solve.error, 1);
    const double error = (test::stacked(liquid.particles.velocity) - exact).norm();
    EXPECT_LT(error, tolerance * scale) << tolerance;
    EXPECT_GT(error, 0.02 * tolerance * scale) << tolerance << ": more exact than was asked for";
  }
}

TEST(Viscosity, LeavesRigidMotionAlone) {
  const auto points = test::blob(0.3, static_cast<double>(kSpacing));
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.push_back(Vec3(3, -1, 2) + Vec3(0.5, 2, -1).cross(x));
  Liquid liquid(points, velocity, kSpacing);
  ViscositySolver(options(1, 1e-3)).solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LT((liquid.particles.velocity[i] - padded(velocity[liquid.particles.id[i]])).norm(), 2e-5);
}

// Cells of every width that hold one particle alone, beside cells of many: what such a one has of turning is
// less than what rounding leaves of its neighbours' moments.
TEST(Viscosity, OneParticleBesideABlockIsSolvedForAtAnyViscosity) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> along(0.05, 1.55), near(0.5, 1.3);
  const double spacing = static_cast<double>(kSpacing);
  for (int k = 0; k < 12; ++k) {
    std::vector<Vec3> points = test::block(Vec3::Zero(), Vec3::Constant(1.6), spacing);
    points.emplace_back(1.55 + near(random) * spacing, along(random), along(random));
    Liquid liquid(points, swirling(points), kSpacing);
    const ViscositySolve solve = ViscositySolver(options(std::pow(10, k % 6), 1e-2))
                                     .solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
    EXPECT_LE(solve.error, 1) << k;
    for (const Vec4f& v : liquid.particles.velocity) ASSERT_TRUE(v.allFinite()) << k;
  }
}

TEST(Viscosity, ConservesLinearAndAngularMomentumAtALooseTolerance) {
  const auto points = test::blob(0.35, static_cast<double>(kSpacing));
  Liquid liquid(points, swirling(points), kSpacing);
  const auto momenta = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < liquid.particles.size(); ++i) {
      const Vec3 x = liquid.particles.position[i].head<3>().cast<double>();
      const Vec3 v = liquid.particles.velocity[i].head<3>().cast<double>();
      sum.head<3>() += v;
      sum.tail<3>() += x.cross(v);
    }
    return sum;
  };
  const auto before = momenta();
  const std::vector<Vec4f> velocity = liquid.particles.velocity;
  ViscositySolver(options(1, 0.1)).solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
  EXPECT_LT((momenta() - before).norm(), 1e-5 * before.norm());
  EXPECT_GT((liquid.particles.velocity[0] - velocity[0]).norm(), 0.05) << "nothing happened";
}

// nu lap v for the parabolic shear v = a (b . x)^2, a and b orthonormal, is 2 nu a, in every direction, on
// the lattice with which liquid starts.
TEST(Viscosity, OperatorIsTheLaplacianOnALattice) {
  const double nu = 0.7;
  const auto points = test::block({-0.25, -0.25, -0.25}, {0.25, 0.25, 0.25}, static_cast<double>(kSpacing));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
  Liquid liquid(points, points, kSpacing);
  std::vector<Vec4f> image;
  for (int k = 0; k < 50; ++k) {
    const Vec3 a = k == 0 ? Vec3::UnitX() : direction(),
               b = a.cross(k == 0 ? Vec3::UnitZ() : direction()).normalized();
    std::size_t center = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 x = liquid.particles.position[i].head<3>().cast<double>();
      liquid.particles.velocity[i] = padded(a * std::pow(b.dot(x), 2));
      if (x.norm() < 1e-3) center = i;
    }
    ViscositySolver(options(nu, 1e-3))
        .apply(liquid.particles, liquid.lists, liquid.wall_sums, 1, liquid.particles.velocity, image);
    const Vec4f acceleration = liquid.particles.velocity[center] - image[center];
    EXPECT_LT((acceleration - padded(2 * nu * a)).norm(), 1e-3 * 2 * nu)
        << a.transpose() << ", " << b.transpose();
  }
}

// For particles anywhere with the mean density 1 / spacing^3 the sum over neighbours is an integral, and its
// (x y)^2 moment that of the Laplacian: sum_j c x^2 y^2 = 4 pi / 15 int c r^6 dr / spacing^3 = 2.
TEST(Viscosity, WeightIsNormalisedInTheContinuum) {
  const ViscosityWeight weight(2);
  double sum = 0, least = 1;
  const int n = 2000;
  for (int k = 0; k < n; ++k) {
    const double r = 2 * (k + 0.5) / n;
    const double c = static_cast<double>(weight(static_cast<float>(r * r)));
    sum += 4 * M_PI / 15 * c * std::pow(r, 6) * 2 / n;
    least = std::min(least, c);
  }
  EXPECT_NEAR(sum, 2, 1e-4);
  EXPECT_GE(least, 0);
}

/// A layer of liquid half a spacing above a wall whose particles are those of sample_walls().
Liquid sliding_layer(const Vec3& velocity, const BodyMotion& motion = {}) {
  const double h = static_cast<double>(kSpacing);
  const auto walls = solid_walls(std::vector{test::box_surface({-2, -1, -2}, {2, 0, 2})});
  const auto points = test::block({-1, 0, -1}, {1, h, 1}, h);
  return Liquid(points, std::vector<Vec3>(points.size(), velocity), kSpacing, sample_walls(walls, h), motion);
}

double mean_speed(const Liquid& liquid, int axis) {
  double mean = 0;
  for (const Vec4f& v : liquid.particles.velocity)
    mean += static_cast<double>(v[axis]) / static_cast<double>(liquid.particles.size());
  return mean;
}

// The layer feels the stress nu v / (h/2 + slip) over its thickness h: in an implicit step dt its speed falls
// to 1 / (1 + dt nu / (h (h/2 + slip))). Wall particles are irregular, and so is the speed within the layer:
// 3 percent.
TEST(Viscosity, FrictionIsTheShearStressAtTheWallsSurface) {
  const double h = static_cast<double>(kSpacing), nu = 3;
  for (const double slip : {0.0, 0.3 * h, 5 * h, std::numeric_limits<double>::infinity()}) {
    FluidOptions o = options(nu, 1e-5);
    o.slip_length = slip;
    Liquid liquid = sliding_layer(Vec3(1, 0, 0));
    ViscositySolver(o).solve(liquid.particles, liquid.lists, liquid.wall_sums, kTimeStep);
    const double rate = static_cast<double>(kTimeStep) * nu / (h * (h / 2 + slip));
    EXPECT_NEAR(mean_speed(liquid, 0), 1 / (1 + rate), 0.03 * rate / (1 + rate) + 1e-6) << slip;
  }
}

TEST(Viscosity, WallsDoNotHoldLiquidThatLeavesOrMovesWithThem) {
  Liquid leaving = sliding_layer(Vec3(0, 1, 0));
  ViscositySolver(options(3, 1e-5)).solve(leaving.particles, leaving.lists, leaving.wall_sums, kTimeStep);
  EXPECT_NEAR(mean_speed(leaving, 1), 1, 1e-5);
  BodyMotion motion;
  motion.keys = {{0, Vec3(1, 0, -2), 0}};
  Liquid carried = sliding_layer(Vec3(1, 0, -2), motion);
  ViscositySolver(options(3, 1e-5)).solve(carried.particles, carried.lists, carried.wall_sums, kTimeStep);
  for (const Vec4f& v : carried.particles.velocity) EXPECT_LT((v - Vec4f(1, 0, -2, 0)).norm(), 1e-5);
}

}  // namespace
}  // namespace kappaflow
