#include <gtest/gtest.h>

#include "core/errors.h"
#include "surface/field/particle_weights.h"
#include "tests/surface/field/random_particles.h"

namespace kappaflow {
namespace {

std::vector<Vec3> cubic_lattice(int side, double spacing) {
  std::vector<Vec3> position;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) position.push_back(spacing * Vec3(i, j, k));
  return position;
}

double direct_sum(const std::vector<Vec3>& position, const std::vector<double>& weight, double sigma,
                  const Vec3& x) {
  double sum = 0;
  for (std::size_t j = 0; j < position.size(); ++j)
    sum += weight[j] * std::pow(std::max(0.0, 1 - (x - position[j]).squaredNorm() / (sigma * sigma)), 3);
  return sum;
}

TEST(FieldWeights, UniformAreOne) {
  EXPECT_EQ(field_weights(cubic_lattice(2, 1), 2, WeightRule::uniform), std::vector<double>(8, 1.0));
}

TEST(FieldWeights, NormalisedOfALoneParticleIsOne) {
  EXPECT_EQ(field_weights(std::vector<Vec3>{Vec3(1, 2, 3)}, 0.4, WeightRule::normalised),
            std::vector<double>{1.0});
}

TEST(FieldWeights, NormalisedAreOneOverTheKernelSum) {
  std::mt19937 random(1);
  std::vector<Vec3> position(200);
  for (Vec3& x : position) x = testing::random_vector(random, 2);
  const std::vector<double> weight = field_weights(position, 0.9, WeightRule::normalised), ones(200, 1.0);
  for (std::size_t i = 0; i < 200; ++i)
    EXPECT_NEAR(weight[i], 1 / direct_sum(position, ones, 0.9, position[i]), 1e-13);
}

TEST(FieldWeights, NormalisedMakeTheInteriorOneOnALattice) {
  const double h = 0.1, sigma = 2 * h;
  const std::vector<Vec3> position = cubic_lattice(12, h);
  const std::vector<double> weight = field_weights(position, sigma, WeightRule::normalised);
  std::mt19937 random(2);
  for (int i = 0; i < 100; ++i) {
    const Vec3 x = Vec3::Constant(5.5 * h) + testing::random_vector(random, 1.5 * h);
    EXPECT_NEAR(direct_sum(position, weight, sigma, x), 1, 0.04);
  }
}

TEST(Threshold, IsHalfTheMedianOfTheFieldAtTheParticles) {
  std::mt19937 random(3);
  for (const int count : {1, 2, 51, 100}) {
    std::vector<Vec3> position(count);
    std::vector<double> weight(count), sums;
    for (int i = 0; i < count; ++i)
      position[i] = testing::random_vector(random, 1), weight[i] = 0.5 + 0.01 * i;
    for (const Vec3& x : position) sums.push_back(direct_sum(position, weight, 0.8, x));
    std::sort(sums.begin(), sums.end());
    const double median = count % 2 == 1 ? sums[count / 2] : (sums[count / 2 - 1] + sums[count / 2]) / 2;
    EXPECT_NEAR(half_median_threshold(position, weight, 0.8), median / 2, 1e-13);
  }
}

// Fujisawa et al. give no threshold; with sigma = 2 spacings the interior is about 5.2.
TEST(Threshold, OfALargeLatticeIsHalfTheInteriorValue) {
  const std::vector<Vec3> position = cubic_lattice(24, 0.1);
  EXPECT_NEAR(half_median_threshold(position, std::vector<double>(position.size(), 1.0), 0.2), 2.6, 0.1);
}

TEST(Threshold, NeedsAParticle) {
  EXPECT_THROW(half_median_threshold({}, {}, 1), InvalidInput);
}

TEST(ParticleSpacing, OfLatticesAndJitteredBodies) {
  std::mt19937 random(3);
  for (const double h : {0.01, 3.0}) {
    std::vector<Vec3> position = cubic_lattice(12, h);
    EXPECT_NEAR(particle_spacing(position), h, 0.02 * h);
    for (Vec3& x : position) x += 0.2 * h * testing::random_vector(random, 1);
    EXPECT_NEAR(particle_spacing(position), h, 0.03 * h);
    std::erase_if(position, [&](const Vec3& x) { return x.z() > 0.5 * h; });
    EXPECT_NEAR(particle_spacing(position), 1.25 * h, 0.15 * h) << "a sheet";
  }
}

TEST(ParticleSpacing, TakesParticlesThatLieApart) {
  EXPECT_THROW(particle_spacing(std::vector<Vec3>{Vec3::Zero()}), InvalidInput);
  EXPECT_THROW(particle_spacing(std::vector<Vec3>(5, Vec3(1, 2, 3))), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
