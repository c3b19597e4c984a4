#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "core/point_tree.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f;

std::vector<Vec3> at_rest(std::size_t n) {
  return std::vector<Vec3>(n, Vec3::Zero());
}

std::vector<Vec3> random_points(std::size_t n, double extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, extent);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = Vec3(uniform(random), uniform(random), uniform(random));
  return points;
}

/// Pairs of particle i, without the padding.
std::vector<std::pair<std::uint32_t, std::uint16_t>> pairs_of(const Liquid& liquid, std::size_t i) {
  std::vector<std::pair<std::uint32_t, std::uint16_t>> pairs;
  for (const PairBlock& block : liquid.lists.of(i))
    for (std::size_t k = 0; k < kWide; ++k) {
      EXPECT_EQ(block.present()[static_cast<Eigen::Index>(k)], block.factor[k] > 0 ? 1 : 0);
      if (block.factor[k] > 0) pairs.emplace_back(block.base + block.offset[k], block.factor[k]);
    }
  return pairs;
}

std::set<std::uint32_t> neighbours_of(const Liquid& liquid, std::size_t i) {
  std::set<std::uint32_t> neighbours;
  for (const auto& [j, factor] : pairs_of(liquid, i)) neighbours.insert(j);
  return neighbours;
}

void expect_as_brute_force(const Liquid& liquid) {
  const auto& x = liquid.particles.position;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto found = neighbours_of(liquid, i);
    ASSERT_EQ(found.size(), pairs_of(liquid, i).size()) << "an index occurs twice";
    for (std::uint32_t j = 0; j < x.size(); ++j) {
      const double distance = (x[i] - x[j]).cast<double>().norm(),
                   support = 2 * static_cast<double>(kSpacing);
      if (std::abs(distance - support) < 1e-6) continue;  // either is right
      ASSERT_EQ(found.contains(j), j != i && distance < support) << i << " " << j;
    }
  }
}

TEST(Neighbours, AgreeWithBruteForce) {
  const auto points = random_points(700, 0.9, 1);
  expect_as_brute_force(Liquid(points, at_rest(points.size()), kSpacing));
}

TEST(Neighbours, AgreeWithBruteForceOnDegenerateInput) {
  for (const std::vector<Vec3>& points :
       {std::vector<Vec3>{Vec3(1, 2, 3)}, std::vector<Vec3>(100, Vec3(0.3, -0.2, 0.1)),  // all in one place
        std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0.1, 0, 0), Vec3(1e5, 0, -1e5)},           // one far off
        test::block({0, 0, 0}, {0.5, 0.5, 0.1}, 0.1),  // a sheet on cell borders
        test::block({-0.05, -0.05, -0.05}, {0.55, 0.55, 0.55}, 0.1)})
    expect_as_brute_force(Liquid(points, at_rest(points.size()), kSpacing));
}

struct Cloud {
  std::span<const Vec4f> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

TEST(Neighbours, CountAsNanoflann) {
  const auto points = random_points(20000, 3, 2);
  const Liquid liquid(points, at_rest(points.size()), kSpacing);
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;
  const Cloud cloud{liquid.particles.position};
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  PointsInReach<float> found;
  std::size_t differing = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::size_t count =
        tree.radiusSearch(liquid.particles.position[i].data(), 4 * kSpacing * kSpacing, found, {});
    differing += count - 1 != pairs_of(liquid, i).size();
  }
  EXPECT_LE(differing, 2u);  // pairs whose distance rounds to the support
}

// Nine lines of 2^16 particles, each in a row of cells of its own: each particle's neighbours in the lines
// beside its own are further apart in the order than a block's offsets reach, and take a block each.
TEST(Neighbours, MayBeFurtherApartThanABlockReaches) {
  constexpr int kLength = 65600;
  constexpr double kFirst = 0.16, kApart = 0.14;  // the cells begin at 0, 0.2, 0.4
  std::vector<Vec3> points{Vec3::Zero()};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < kLength; ++i)
        points.emplace_back(0.21 * (i + 2), kFirst + kApart * j, kFirst + kApart * k);
  const Liquid liquid(points, at_rest(points.size()), kSpacing);
  std::size_t blocks_max = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t neighbours = 0;
    for (const PairBlock& block : liquid.lists.of(i))
      neighbours += static_cast<std::size_t>(block.present().sum());
    if (liquid.particles.position[i].isZero()) continue;
    const Vec3 x = liquid.particles.position[i].head<3>().cast<double>();
    const Vec3 at = ((x.array() - kFirst) / kApart).round();
    const int beside = (at[1] == 1 ? 3 : 2) * (at[2] == 1 ? 3 : 2) - 1;  // sides and diagonals of a square
    ASSERT_EQ(neighbours, static_cast<std::size_t>(beside)) << i;
    blocks_max = std::max(blocks_max, liquid.lists.of(i).size());
  }
  EXPECT_EQ(blocks_max, 8u);
}

TEST(Neighbours, SortingCarriesEveryAttribute) {
  const auto points = random_points(500, 1, 3);
  std::vector<Vec3> velocity(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) velocity[i] = 2 * points[i];
  Liquid liquid(points, velocity, kSpacing);
  auto& p = liquid.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.density_pressure[i] = static_cast<float>(p.id[i]);
    p.divergence_pressure[i] = -static_cast<float>(p.id[i]);
    p.viscous_velocity[i] = Vec4f::Constant(static_cast<float>(p.id[i]));
    p.position[i] = Vec4f(0.4f, -0.3f, 0.2f, 0) - p.position[i];
  }
  liquid.update();
  std::set<std::uint32_t> ids;
  for (std::size_t i = 0; i < p.size(); ++i) {
    ids.insert(p.id[i]);
    EXPECT_EQ(p.density_pressure[i], static_cast<float>(p.id[i]));
    EXPECT_EQ(p.divergence_pressure[i], -static_cast<float>(p.id[i]));
    EXPECT_EQ(p.viscous_velocity[i], Vec4f::Constant(static_cast<float>(p.id[i])));
    EXPECT_EQ(p.velocity[i], padded(velocity[p.id[i]]));
    EXPECT_EQ(p.position[i], Vec4f(0.4f, -0.3f, 0.2f, 0) - padded(points[p.id[i]]));
  }
  EXPECT_EQ(ids.size(), points.size());
}

TEST(Neighbours, FactorsAreSymmetricToTheBitAndRounded) {
  const auto points = random_points(400, 0.7, 4);
  const Liquid liquid(points, at_rest(points.size()), kSpacing);
  const CubicSpline kernel(2 * kSpacing);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    for (const auto& [j, factor] : pairs_of(liquid, i)) {
      const auto back = pairs_of(liquid, j);
      ASSERT_EQ(std::ranges::count(back, std::pair(i, factor)), 1);
      const Vec4f x = liquid.particles.position[i] - liquid.particles.position[j];
      const float exact = kSpacing * kSpacing * kSpacing * kernel.gradient_factor(x.head<3>().norm());
      EXPECT_NEAR(-liquid.lists.unit * factor, exact, 1.01f * liquid.lists.unit);
    }
}

TEST(Neighbours, LatticeIsAtRestDensityInside) {
  const auto points = test::block({0, 0, 0}, {1, 1, 1}, kSpacing);
  const Liquid liquid(points, at_rest(points.size()), kSpacing);
  int inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Array3f x = liquid.particles.position[i].head<3>().array();
    if ((x < 0.2f).any() || (x > 0.8f).any()) continue;
    ++inside;
    EXPECT_NEAR(liquid.particles.density[i], 1, 2e-4);
    EXPECT_LT(liquid.particles.gradient_sum[i].norm() * kSpacing, 1e-4);
  }
  EXPECT_EQ(inside, 216);
}

}  // namespace
}  // namespace kappaflow
