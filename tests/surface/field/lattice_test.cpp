#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/surface/field/random_particles.h"

namespace kappaflow {
namespace {

using testing::random_particles;

SampledField lattice(const Vec3& origin, double spacing, const std::array<int, 3>& dims) {
  SampledField samples;
  samples.origin = origin;
  samples.spacing = spacing;
  samples.dims = dims;
  return samples;
}

// Lattices larger than the particles' bounds, cutting through them, of one slab and of many, of one plane,
// and empty.
const SampledField kLattices[] = {
    lattice(Vec3(-4, -4, -4), 0.31, {27, 26, 25}), lattice(Vec3(-0.5, -0.7, -0.1), 0.11, {13, 7, 9}),
    lattice(Vec3(-3, -3, 0.2), 0.2, {31, 30, 1}),  lattice(Vec3(-3, -3, -3), 2.5, {3, 3, 3}),
    lattice(Vec3(20, 0, 0), 0.5, {4, 4, 4}),       lattice(Vec3(0, 0, 0), 0.5, {0, 3, 3})};

TEST(SampledParticleField, IsEquation12AtEveryLatticePoint) {
  const ParticleField field(random_particles(71, 120, 2), 0.3, 0);
  for (SampledField samples : kLattices) {
    SampledField by_point = samples;
    field.sample(samples);
    field.Field::sample(by_point);
    ASSERT_EQ(samples.value.size(), by_point.value.size());
    for (std::size_t i = 0; i < samples.value.size(); ++i)
      ASSERT_NEAR(samples.value[i], by_point.value[i], 1e-6f * (1 + std::abs(by_point.value[i])));
  }
}

TEST(SampledField, DefaultEvaluatesEveryPoint) {
  const ParticleField field(random_particles(72, 30, 1), 0.3, 0);
  SampledField samples = lattice(Vec3(-1, -0.9, -0.8), 0.3, {6, 5, 4});
  field.Field::sample(samples);
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 6; ++i)
        EXPECT_EQ(samples.value[(k * 5 + j) * 6 + i],
                  static_cast<float>(field.value_and_gradient(samples.origin + 0.3 * Vec3(i, j, k)).f));
}

TEST(SampledParticleField, IsTheSameForAnyNumberOfThreads) {
  const FieldParticles particles = random_particles(73, 3000, 4);
  std::vector<std::vector<float>> results;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    SampledField samples = lattice(Vec3(-5, -5, -5), 0.17, {60, 60, 60});
    ParticleField(particles, 0.3, 0).sample(samples);
    results.push_back(samples.value);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace kappaflow
