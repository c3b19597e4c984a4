#include <gtest/gtest.h>

#include "core/errors.h"
#include "surface/field/particle_motion.h"
#include "surface/field/particle_weights.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
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

/// A cube of 6^3 particles at the spacing h beside one of 12^3 at h/2: equal bodies, whose scales are 2
/// and 1.
TEST(ParticleSpacing, ParticlesOfSeveralSizesMakeBodiesOfTheSameField) {
  constexpr double kH = 0.2;
  std::vector<Vec3> position = cubic_lattice(6, kH);
  std::vector<double> scale(position.size(), 2.0);
  for (const Vec3& x : cubic_lattice(12, kH / 2)) {
    position.push_back(x + Vec3(3, 0, 0));
    scale.push_back(1);
  }
  EXPECT_NEAR(particle_spacing(position, scale), kH / 2, 0.03 * kH / 2);
  const double sigma = kH;  // two spacings of the fine ones
  const std::vector<double> radii = support_radii(position.size(), sigma, scale);
  EXPECT_EQ(radii.front(), 2 * sigma);
  EXPECT_EQ(radii.back(), sigma);
  const std::vector<double> weight = field_weights(position, sigma, WeightRule::uniform, scale);
  const double threshold = half_median_threshold(position, weight, sigma, scale);
  const std::vector<double> fine(1728, 1.0);
  const std::span<const Vec3> fine_only = std::span(position).last(1728);
  EXPECT_NEAR(threshold, half_median_threshold(fine_only, fine, sigma), 0.15 * threshold);

  // As the coarse body is the fine lattice twice as large, so is its surface.
  const auto volume = [&](double spacing, double size) {
    Particles body;
    for (const Vec3& x : cubic_lattice(6, spacing)) {
      body.id.push_back(static_cast<std::int64_t>(body.id.size()));
      body.position.push_back(x);
      body.velocity.push_back(Vec3::Zero());
      body.scale.push_back(size);
    }
    const auto field = particle_field(body, {.sigma = sigma, .threshold = threshold});
    const TriangleMesh mesh = extract_isosurface(*field, 0.25 * sigma * size);
    return area_and_volume(mesh.position, mesh.triangles).volume;
  };
  EXPECT_NEAR(volume(kH, 2), 8 * volume(kH / 2, 1), 1e-6);
  EXPECT_NEAR(volume(kH, 2), std::pow(6 * kH, 3), 0.15 * std::pow(6 * kH, 3)) << "with round edges";
}

TEST(ParticleSpacing, TakesParticlesThatLieApart) {
  EXPECT_THROW(particle_spacing(std::vector<Vec3>{Vec3::Zero()}), InvalidInput);
  EXPECT_THROW(particle_spacing(std::vector<Vec3>(5, Vec3(1, 2, 3))), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
