#include <gtest/gtest.h>

#include <random>

#include "core/errors.h"
#include "solver/boundary_sampling.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::box_surface;

constexpr double kSpacing = 0.05;
constexpr double kDepth = kWallDepth * kSpacing;

std::vector<SolidDistance> distances(const std::vector<TriangleSurface>& walls) {
  return std::vector<SolidDistance>(walls.begin(), walls.end());
}

void expect_at_depth(const std::vector<SolidDistance>& solids, const Vec3& x) {
  const double depth = -nearest_of_union(solids, x).distance;
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
  const std::vector<TriangleSurface> walls{box_surface({0, 0, 0}, {1, 0.5, 0.8})};
  const auto solids = distances(walls);
  const auto samples = sample_walls(walls, solids, kSpacing);
  for (const Vec3& s : samples) expect_at_depth(solids, s);
  double nearest = 1;
  for (std::size_t a = 0; a < samples.size(); ++a)
    for (std::size_t b = a + 1; b < samples.size(); ++b)
      nearest = std::min(nearest, (samples[a] - samples[b]).norm());
  EXPECT_GE(nearest, 0.6 * kSpacing * (1 - 1e-12));
  // No hole: every point of the layer has a sample near.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Vec3 lower = Vec3::Constant(kDepth), upper = Vec3(1, 0.5, 0.8) - lower;
  for (int k = 0; k < 3000; ++k) {
    Vec3 x = lower + Vec3(uniform(random), uniform(random), uniform(random)).cwiseProduct(upper - lower);
    x[k % 3] = k % 2 ? lower[k % 3] : upper[k % 3];
    double gap = 1;
    for (const Vec3& s : samples) gap = std::min(gap, (s - x).norm());
    EXPECT_LT(gap, 0.8 * kSpacing) << x.transpose();
  }
}

TEST(WallSamples, LeaveOutFacesThatAnotherSolidCovers) {
  const std::vector<TriangleSurface> walls{box_surface({0, 0, 0}, {0.6, 0.6, 0.6}),
                                           box_surface({0.3, 0, 0}, {0.9, 0.6, 0.6})};
  const auto solids = distances(walls);
  for (const Vec3& s : sample_walls(walls, solids, kSpacing)) expect_at_depth(solids, s);
}

TEST(WallSamples, RejectAWallThatIsTooThin) {
  const std::vector<TriangleSurface> walls{box_surface({0, 0, 0}, {1, 1.8 * kSpacing, 1})};
  EXPECT_THROW(sample_walls(walls, distances(walls), kSpacing), InvalidInput);
}

/// Density of a lattice whose lowest layer is `height` above a large flat wall, at points away from the
/// lattice's sides.
double density_above_wall(double height) {
  const std::vector<TriangleSurface> walls{box_surface({-1, -0.5, -1}, {2, 0, 2})};
  const auto samples = sample_walls(walls, distances(walls), kSpacing);
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

TEST(Walls, FrictionIsSymmetricAndConfinedToTheContact) {
  const std::vector<TriangleSurface> walls{box_surface({-1, -0.5, -1}, {2, 0, 2})};
  const auto samples = sample_walls(walls, distances(walls), kSpacing);
  const std::vector<Vec3> points{Vec3(0.5, 0.02, 0.5), Vec3(0.5, 0.3, 0.5)};
  const test::Liquid liquid(points, points, static_cast<float>(kSpacing), samples);
  for (std::size_t i = 0; i < 2; ++i) {
    const Eigen::Matrix3f friction = liquid.wall_sums.friction[i].topRows<3>();
    EXPECT_TRUE(friction.isApprox(friction.transpose()) || friction.isZero());
    const bool near = liquid.particles.id[i] == 0;
    EXPECT_EQ(static_cast<bool>(liquid.wall_sums.touches[i]), near);
    EXPECT_EQ(friction.isZero(), !near);
  }
}

}  // namespace
}  // namespace kappaflow
