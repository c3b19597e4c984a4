#include <gtest/gtest.h>

#include <array>
#include <random>

#include "core/errors.h"
#include "core/solid_wall.h"
#include "solver/boundary_sampling.h"
#include "solver/pressure.h"
#include "solver/surface_tension.h"
#include "solver/viscosity.h"
#include "tests/joined.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::box_surface;
using test::joined;

constexpr double kSpacing = 0.05;
constexpr double kDepth = kWallDepth * kSpacing;

void expect_at_depth(std::span<const SolidWall> walls, const Vec3& x) {
  const double depth = -nearest_of_walls(walls, x).distance;
  EXPECT_LT(depth, 1.001 * kDepth) << x.transpose();
  EXPECT_GT(depth, 0.999 * kDepth) << x.transpose();
}

double box_distance(const Vec3& x, const Vec3& lower, const Vec3& upper) {
  const Eigen::Array3d out = (lower - x).array().max((x - upper).array());
  return out.maxCoeff() > 0 ? out.max(0).matrix().norm() : out.maxCoeff();
}

TEST(SolidDistance, OfABoxIsExactInsideAndOutside) {
  const Vec3 lower(-0.3, 0.1, 0.2), upper(0.5, 0.4, 1.1);
  const SolidDistance solid(box_surface(lower, upper));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 2);
  for (int k = 0; k < 5000; ++k) {
    const Vec3 x(uniform(random), uniform(random), uniform(random));
    EXPECT_NEAR(solid.nearest(x).distance, box_distance(x, lower, upper), 1e-12);
  }
}

TEST(SolidDistance, SignIsRightAtCornersAndEdges) {
  const SolidDistance solid(box_surface(Vec3::Zero(), Vec3::Ones()));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  for (int corner = 0; corner < 8; ++corner)
    for (int k = 0; k < 500; ++k) {
      const Vec3 x = Vec3(corner & 1, corner >> 1 & 1, corner >> 2) +
                     Vec3(uniform(random), uniform(random), uniform(random));
      EXPECT_NEAR(solid.nearest(x).distance, box_distance(x, Vec3::Zero(), Vec3::Ones()), 1e-12)
          << x.transpose();
    }
}

TEST(SolidDistance, RejectsWhatIsNoSurface) {
  TriangleSurface surface = box_surface(Vec3::Zero(), Vec3::Ones());
  surface.triangles.push_back({0, 1, 8});
  EXPECT_THROW(SolidDistance{surface}, InvalidInput);
  EXPECT_THROW(SolidDistance{TriangleSurface{}}, InvalidInput);
  surface = box_surface(Vec3::Zero(), Vec3::Ones());
  surface.vertices[3].x() = std::nan("");
  EXPECT_THROW(SolidDistance{surface}, InvalidInput);
}

TEST(WallSamples, CoverTheLayerEvenly) {
  const auto walls = solid_walls(std::vector{box_surface({0, 0, 0}, {1, 0.5, 0.8})});
  const auto samples = sample_walls(walls, kSpacing);
  for (const WallSample& s : samples) expect_at_depth(walls, s.position);
  double nearest = 1;
  for (std::size_t a = 0; a < samples.size(); ++a)
    for (std::size_t b = a + 1; b < samples.size(); ++b)
      nearest = std::min(nearest, (samples[a].position - samples[b].position).norm());
  EXPECT_GE(nearest, 0.6 * kSpacing * (1 - 1e-12));
  // No hole: every point of the layer has a sample near.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 lower = Vec3::Constant(kDepth), upper = Vec3(1, 0.5, 0.8) - lower;
  for (int k = 0; k < 3000; ++k) {
    Vec3 x = lower + Vec3(uniform(random), uniform(random), uniform(random)).cwiseProduct(upper - lower);
    x[k % 3] = k % 2 ? lower[k % 3] : upper[k % 3];
    double gap = 1;
    for (const WallSample& s : samples) gap = std::min(gap, (s.position - x).norm());
    EXPECT_LT(gap, 0.8 * kSpacing) << x.transpose();
  }
}

TEST(WallSamples, LeaveOutFacesThatAnotherSolidCovers) {
  const auto walls = solid_walls(
      std::vector{box_surface({0, 0, 0}, {0.6, 0.6, 0.6}), box_surface({0.3, 0, 0}, {0.9, 0.6, 0.6})});
  for (const WallSample& s : sample_walls(walls, kSpacing)) expect_at_depth(walls, s.position);
}

/// A step of height 0.4 at x = 0.5, in one piece.
TriangleSurface step_surface() {
  const std::vector<Vec2> profile{{0.5, 0}, {-1, 0}, {-1, -0.5}, {2, -0.5}, {2, 0.4}, {0.5, 0.4}};
  TriangleSurface step;
  for (const double z : {-1.0, 2.0})
    for (const Vec2& p : profile) step.vertices.emplace_back(p.x(), p.y(), z);
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    step.triangles.insert(step.triangles.end(), {{k, next, next + 6}, {k, next + 6, k + 6}});
    if (k > 0 && k < 5) step.triangles.insert(step.triangles.end(), {{0, k + 1, k}, {6, k + 6, k + 7}});
  }
  return step;
}

/// Mean density of a lattice of liquid in the corner of the step, over the particles that touch both walls.
double density_in_corner(const std::vector<WallSample>& samples) {
  const auto points = test::block({-0.3, 0, 0}, {0.5, 0.3, 1}, kSpacing);
  const test::Liquid liquid(points, points, static_cast<float>(kSpacing), samples);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 x = liquid.particles.position[i].head<3>().cast<double>();
    if (x.x() < 0.5 - kSpacing || x.y() > kSpacing || x.z() < 0.15 || x.z() > 0.85) continue;
    sum += static_cast<double>(liquid.particles.density[i]);
    ++count;
  }
  EXPECT_EQ(count, 14);
  return sum / count;
}

// Overlapping boxes in one surface, and one that lies in another, against the same step in one piece.
TEST(WallSamples, OfOverlappingPiecesAreThoseOfTheirUnion) {
  const auto step = solid_walls(std::vector{step_surface()});
  const auto pieces = solid_walls(
      std::vector{joined({box_surface({-1, -0.5, -1}, {2, 0, 2}), box_surface({0.5, -0.3, -1}, {2, 0.4, 2}),
                          box_surface({-0.4, -0.4, 0.2}, {0.3, -0.05, 0.6})})});
  const auto of_step = sample_walls(step, kSpacing), of_pieces = sample_walls(pieces, kSpacing);
  for (const WallSample& s : of_pieces) expect_at_depth(step, s.position);
  const auto count = [](const auto& samples) { return static_cast<double>(samples.size()); };
  EXPECT_NEAR(count(of_pieces), count(of_step), 0.02 * count(of_step));
  EXPECT_NEAR(density_in_corner(of_pieces), density_in_corner(of_step), 0.01);
}

// Each triangle of the ends has two edges that are the longest but for rounding.
TEST(WallSamples, OfADrumWithManySectors) {
  constexpr int kSectors = 96;
  TriangleSurface drum;
  for (const double y : {0.0, -2.0 / 3}) drum.vertices.emplace_back(0, y, 0);
  for (const double y : {0.0, -2.0 / 3})
    for (int j = 0; j < kSectors; ++j) {
      const double angle = 2 * std::numbers::pi * j / kSectors;
      drum.vertices.emplace_back(14.0 / 3 * std::cos(angle), y, 14.0 / 3 * std::sin(angle));
    }
  for (int j = 0; j < kSectors; ++j) {
    const int a = 2 + j, b = 2 + (j + 1) % kSectors, c = a + kSectors, d = b + kSectors;
    for (const Triangle& t : {Triangle{0, b, a}, {1, c, d}, {a, b, d}, {a, d, c}})
      drum.triangles.push_back(t);
  }
  const std::vector<SolidWall> walls{SolidWall(drum)};
  for (const WallSample& sample : sample_walls(walls, 1.0 / 3))
    EXPECT_NEAR(nearest_of_walls(walls, sample.position).distance, -kWallDepth / 3, 1e-3);
}

TEST(WallSamples, RejectWallsThatAreTooLargeToCount) {
  const auto walls = solid_walls(std::vector{box_surface({0, 0, 0}, {1e6, 1e6, 1})});
  EXPECT_THROW(sample_walls(walls, kSpacing), InvalidInput);
}

TEST(WallSamples, RejectAWallThatIsTooThin) {
  const auto walls = solid_walls(std::vector{box_surface({0, 0, 0}, {1, 1.8 * kSpacing, 1})});
  EXPECT_THROW(sample_walls(walls, kSpacing), InvalidInput);
}

/// Density of a lattice whose lowest layer is `height` above a large flat wall, at points away from the
/// lattice's sides.
double density_above_wall(double height) {
  const auto walls = solid_walls(std::vector{box_surface({-1, -0.5, -1}, {2, 0, 2})});
  const auto samples = sample_walls(walls, kSpacing);
  const double base = height - 0.5 * kSpacing;
  const auto points = test::block({0, base, 0}, {1, base + 0.3, 1}, kSpacing);
  const test::Liquid liquid(points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                            static_cast<float>(kSpacing), samples);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d x = liquid.particles.position[i].head<3>().cast<double>();
    if (x.y() > base + kSpacing || std::min(x.x(), x.z()) < 0.15 || std::max(x.x(), x.z()) > 0.85) continue;
    sum += static_cast<double>(liquid.particles.density[i]);
    ++count;
  }
  return sum / count;
}

TEST(Walls, LatticeHalfASpacingOffIsAtRestDensity) {
  EXPECT_NEAR(density_above_wall(0.5 * kSpacing), 1, 0.01);
  EXPECT_GT(density_above_wall(0.25 * kSpacing), 1.1);
  EXPECT_LT(density_above_wall(1.4 * kSpacing), 0.88);
}

TEST(Walls, FrictionIsConfinedToTheContact) {
  const auto walls = solid_walls(std::vector{box_surface({-1, -0.5, -1}, {2, 0, 2})});
  const auto samples = sample_walls(walls, kSpacing);
  const std::vector<Vec3> points{Vec3(0.5, 0.02, 0.5), Vec3(0.5, 0.3, 0.5)};
  const test::Liquid liquid(points, points, static_cast<float>(kSpacing), samples);
  const WallSums& sums = liquid.wall_sums;
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(sums.touches(i), liquid.particles.id[i] == 0);
  ASSERT_EQ(sums.friction.size(), 1u);
  EXPECT_LT((sums.friction[0].head<3>() - Eigen::Vector3f::UnitY()).norm(), 1e-5f);
  EXPECT_TRUE(sums.velocity.empty());
}

// g = 1 / (spacing d) at the distance d from a flat wall, in the mean over places.
TEST(Walls, FrictionFollowsTheDistanceWhereLiquidRests) {
  const auto walls = solid_walls(std::vector{box_surface({-1, -0.5, -1}, {2, 0, 2})});
  const auto samples = sample_walls(walls, kSpacing);
  for (const double distance : {0.4, 0.5, 0.6}) {
    std::vector<Vec3> points = test::block({0, 0, 0}, {1, kSpacing, 1}, kSpacing);
    for (Vec3& x : points) x.y() = distance * kSpacing;
    const test::Liquid liquid(points, points, static_cast<float>(kSpacing), samples);
    double mean = 0;
    for (const Vec4f& f : liquid.wall_sums.friction)
      mean += static_cast<double>(f[3]) / static_cast<double>(points.size());
    EXPECT_NEAR(mean * kSpacing * kSpacing * distance, 1, 0.07) << distance;
  }
}

// Particles in the place of a wall's particle, and of each other.
TEST(Walls, CoincidingParticlesGiveFiniteForces) {
  const auto walls = solid_walls(std::vector{box_surface({-1, -0.5, -1}, {1, 0, 1})});
  const auto samples = sample_walls(walls, kSpacing);
  std::vector<Vec3> points;
  for (std::size_t s = 0; s < samples.size(); s += 7) points.insert(points.end(), 2, samples[s].position);
  std::vector<Vec3> velocity(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) velocity[i] = Vec3(i % 2 == 0 ? 1 : -1, 0.5, 0);
  test::Liquid liquid(points, velocity, static_cast<float>(kSpacing), samples);
  ASSERT_GT(points.size(), 100u);
  FluidOptions options;
  options.spacing = kSpacing;
  options.surface_tension = 1;
  SurfaceTension(options).apply(liquid.particles, liquid.lists, 1e-3f);
  const ViscositySolve viscosity =
      ViscositySolver(options).solve(liquid.particles, liquid.lists, liquid.wall_sums, 1e-3f);
  EXPECT_LE(viscosity.error, 1);
  PressureSolver pressure(options);
  pressure.correct_density(liquid.particles, liquid.lists, liquid.wall_sums, 1e-3f);
  pressure.correct_divergence(liquid.particles, liquid.lists, liquid.wall_sums, 1e-3f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_TRUE(liquid.wall_sums.touches(i));
    EXPECT_TRUE(liquid.wall_sums.friction[liquid.wall_sums.first[i]].allFinite()) << i;
    EXPECT_TRUE(std::isfinite(liquid.particles.density[i]) && liquid.particles.gradient_sum[i].allFinite());
    EXPECT_TRUE(liquid.particles.velocity[i].allFinite()) << i;
  }
}

// The far side of a wall is not felt: neither by the samples' volumes nor by the liquid.
TEST(Walls, AThinWallIsAsGoodAsAThickOne) {
  std::array<double, 2> mean{};
  for (const bool thin : {true, false}) {
    const double thickness = thin ? 1.01 * kThinnestWall * kSpacing : 0.5;
    const auto walls = solid_walls(std::vector{box_surface({-1, -thickness, -1}, {2, 0, 2})});
    const auto points = test::block({0, 0, 0}, {1, 0.3, 1}, kSpacing);
    const test::Liquid liquid(points, points, static_cast<float>(kSpacing), sample_walls(walls, kSpacing));
    for (std::size_t i = 0; i < points.size(); ++i)
      if (liquid.wall_sums.touches(i)) mean[thin] += static_cast<double>(liquid.particles.density[i]) / 400;
  }
  EXPECT_NEAR(mean[true], mean[false], 2e-3);
}

BodyMotion turning() {
  BodyMotion motion;
  motion.keys = {{0, Vec3(0.2, -0.1, 0.4), 0.7}};
  motion.axis = Vec3(2, 1, 2) / 3;
  motion.point = Vec3(0.3, 0.5, 0.1);
  return motion;
}

// A body that has moved acts as one that was built where it is.
TEST(Walls, AMovedBodyIsFeltWhereItIs) {
  const auto walls = solid_walls(std::vector{box_surface({0, -0.3, 0}, {0.6, 0, 0.6})});
  const BodyMotion motion = turning();
  const double time = 1.3;
  auto samples = sample_walls(walls, kSpacing);
  std::vector<Vec3> points = test::block({0, 0, 0}, {0.6, 0.1, 0.6}, kSpacing);
  for (Vec3& x : points) x = motion.pose(time) * x;
  test::Liquid moving(points, points, static_cast<float>(kSpacing), samples, motion);
  moving.walls.move_to(time);
  moving.update();
  for (WallSample& s : samples) s = {motion.pose(time) * s.position, motion.pose(time).rotation * s.normal};
  const test::Liquid placed(points, points, static_cast<float>(kSpacing), samples);
  ASSERT_GT(moving.wall_sums.friction.size(), 100u);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(moving.particles.density[i], placed.particles.density[i], 1e-3f);
    EXPECT_LT((moving.particles.gradient_sum[i] - placed.particles.gradient_sum[i]).norm(), 1e-2f);
    ASSERT_EQ(moving.wall_sums.touches(i), placed.wall_sums.touches(i));
    if (!placed.wall_sums.touches(i)) continue;
    const Vec4f u(1, 2, 3, 0);
    const Vec4f difference = moving.wall_sums.drag(i, u) - placed.wall_sums.drag(i, u);
    EXPECT_LT(difference.norm(), 1e-3f * placed.wall_sums.drag(i, u).norm() + 0.1f);
  }
  EXPECT_GE(moving.walls.fastest(),
            motion.velocity(time).at(motion.pose(time) * Vec3(0.6, -0.3, 0.6)).norm() - 0.1);
}

// The rate of density that a moving wall causes, against the difference of densities; liquid at rest.
TEST(Walls, DensityRateMatchesFiniteDifferences) {
  const auto walls = solid_walls(std::vector{box_surface({0, -0.3, 0}, {0.6, 0, 0.6})});
  const auto points = test::block({0, 0, 0}, {0.6, 0.1, 0.6}, kSpacing);
  test::Liquid liquid(points, points, static_cast<float>(kSpacing), sample_walls(walls, kSpacing), turning());
  const float step = 2e-3f;
  std::vector<float> rate, before, after;
  for (std::size_t i = 0; i < points.size(); ++i) rate.push_back(liquid.wall_sums.density_rate(i));
  for (const float time : {-step, step}) {
    liquid.walls.move_to(static_cast<double>(time));
    liquid.update();
    (time < 0 ? before : after) = liquid.particles.density;
  }
  float largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(rate[i], (after[i] - before[i]) / (2 * step), 0.02f);
    largest = std::max(largest, std::abs(rate[i]));
  }
  EXPECT_GT(largest, 1);
}

}  // namespace
}  // namespace kappaflow
