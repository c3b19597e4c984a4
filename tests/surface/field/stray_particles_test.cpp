// Particles that fly off: they change no surface, and cost nothing.
#include "surface/field/stray_particles.h"

#include <gtest/gtest.h>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/field/random_particles.h"

namespace kappaflow {
namespace {

constexpr double kSigma = 2, kThreshold = 3;

/// A cube of particles one apart at the corner `at`.
void add_cube(FieldParticles& particles, const Vec3& at, int side, double sigma = kSigma) {
  for (int n = 0; n < side * side * side; ++n) {
    particles.position.push_back(at + Vec3(n % side, n / side % side, n / side / side));
    particles.velocity.push_back(Vec3::Zero());
    particles.sigma.push_back(sigma);
    particles.weight.push_back(1);
    particles.weight_rate.push_back(0);
  }
}

FieldParticles kept_of(const FieldParticles& particles, double threshold) {
  FieldParticles kept;
  for (const std::uint32_t i :
       without_strays(particles.position, particles.sigma, particles.weight, threshold)) {
    kept.position.push_back(particles.position[i]);
    kept.velocity.push_back(particles.velocity[i]);
    kept.sigma.push_back(particles.sigma[i]);
    kept.weight.push_back(particles.weight[i]);
    kept.weight_rate.push_back(particles.weight_rate[i]);
  }
  return kept;
}

TEST(StrayParticles, AreThoseWithoutASurface) {
  FieldParticles body;
  add_cube(body, Vec3::Zero(), 5);
  EXPECT_EQ(kept_of(body, kThreshold).position, body.position) << "they are near each other";
  FieldParticles with = body;
  add_cube(with, Vec3(1000, 0, 0), 1);
  add_cube(with, Vec3(-1e9, 1e9, 0), 1);
  add_cube(with, Vec3(0, 2e3, 0), 2);  // eight together have one
  const FieldParticles kept = kept_of(with, kThreshold);
  ASSERT_EQ(kept.position.size(), 133u);
  EXPECT_EQ(kept.position.back(), Vec3(1, 2001, 1));
  EXPECT_EQ(kept_of(with, 0.5).position.size(), with.position.size()) << "each has a surface of its own";
}

// The bound takes whole cells: a particle may be kept for nothing, and never be left out wrongly.
TEST(StrayParticles, OnlyThoseAreLeftOutWhoseFieldIsNegativeEverywhere) {
  std::mt19937 random(3);
  FieldParticles spray;
  for (int n = 0; n < 300; ++n) add_cube(spray, testing::random_vector(random, 60), n % 3 == 0 ? 2 : 1);
  add_cube(spray, Vec3(1e4, 0, 0), 1);
  const FieldParticles kept = kept_of(spray, kThreshold);
  EXPECT_LT(kept.position.size(), spray.position.size());
  const auto direct = [&](const FieldParticles& particles, const Vec3& x) {
    double f = -kThreshold;
    for (std::size_t i = 0; i < particles.position.size(); ++i)
      f += std::pow(std::max(0.0, 1 - (x - particles.position[i]).squaredNorm() / (kSigma * kSigma)), 3);
    return f;
  };
  int inside = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 x = spray.position[n % spray.position.size()] + testing::random_vector(random, 2);
    const double f = direct(spray, x), of_kept = direct(kept, x);
    EXPECT_EQ(f >= 0, of_kept >= 0);
    if (f < 0) continue;
    EXPECT_EQ(f, of_kept) << "at " << x.transpose();
    ++inside;
  }
  EXPECT_GT(inside, 20);
}

TEST(StrayParticles, TheSurfaceIsWhatItWasAndItsLatticeAsSmall) {
  FieldParticles body;
  add_cube(body, Vec3::Zero(), 6);
  FieldParticles with = body;
  add_cube(with, Vec3(1e9, 5, 5), 1);
  const ParticleField field(body, kThreshold, 0), far(with, kThreshold, 0);
  EXPECT_EQ(far.bounds().upper, field.bounds().upper);
  const TriangleMesh mesh = extract_isosurface(far, 0.5);
  EXPECT_EQ(mesh.position, extract_isosurface(field, 0.5).position);
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).components, 1);
}

// One with plain weight has none under a threshold above it; with a weight that the threshold is below it
// has.
TEST(StrayParticles, WithoutASurfaceNeedNoBlocks) {
  constexpr int kCells = 32;
  FieldParticles body;
  add_cube(body, Vec3::Zero(), 6);
  FieldParticles spray = body;
  std::mt19937 random(4);
  for (int n = 0; n < 40; ++n) {  // one or two together, in the air around the body
    const Vec3 at = Vec3(20 + 4 * n % 80, 12 * (n % 7), 11 * (n % 5)) + testing::random_vector(random, 1);
    add_cube(spray, at, 1);
    if (n % 2 == 0) add_cube(spray, at + Vec3(1, 0, 0), 1);
  }
  const ParticleField field(spray, kThreshold, 0), low(spray, 0.5, 0);
  const SampledField lattice = isosurface_lattice(field, 0.5);
  const auto cubes = field.occupied_cubes(lattice, kCells).value(),
             of_body = ParticleField(body, kThreshold, 0).occupied_cubes(lattice, kCells).value();
  EXPECT_EQ(cubes, of_body);
  EXPECT_GT(low.occupied_cubes(lattice, kCells).value().size(), 5 * cubes.size());
}

// As brute force says: no point with f >= 0 lies outside the cubes, whatever the weights.
TEST(StrayParticles, CubesHoldEveryPointInsideTheSurface) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> weight(-0.5, 2), sigma(0.6, 2.4);
  FieldParticles spray;
  for (int n = 0; n < 500; ++n) {
    add_cube(spray, testing::random_vector(random, 14), 1, sigma(random));
    spray.weight.back() = weight(random);
  }
  const ParticleField field(spray, 1.9, 0);
  constexpr int kCells = 3;
  SampledField lattice = isosurface_lattice(field, 0.4);
  field.sample(lattice);
  const auto cubes = field.occupied_cubes(lattice, kCells).value();
  std::size_t index = 0, inside = 0;
  for (int k = 0; k < lattice.dims[2]; ++k)
    for (int j = 0; j < lattice.dims[1]; ++j)
      for (int i = 0; i < lattice.dims[0]; ++i, ++index) {
        if (!(lattice.value[index] >= 0)) continue;
        ++inside;
        EXPECT_EQ(std::ranges::count(cubes, std::array{i / kCells, j / kCells, k / kCells}), 1);
      }
  EXPECT_GT(inside, 20u);
  EXPECT_LT(cubes.size() * kCells * kCells * kCells, lattice.value.size() / 2);
}

}  // namespace
}  // namespace kappaflow
