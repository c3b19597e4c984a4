// How Eq. 12 answers a strain of its particles.
#include <gtest/gtest.h>

#include "tests/surface/field/random_particles.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::random_vector;

Mat3 random_matrix(std::mt19937& random) {
  Mat3 m;
  for (int a = 0; a < 3; ++a) m.col(a) = random_vector(random, 1);
  return m;
}

double along(const Mat3& response, const Mat3& G) {
  return response.cwiseProduct(G).sum();
}

// Particles that move affinely, v_i = a + G x_i: the definition of R and its two derivatives by the field's
// own rates.
TEST(StrainResponse, ExplainsTheRatesOfParticlesInAffineMotion) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    FieldParticles particles = testing::random_particles(trial, 40, 1);
    const Vec3 a = random_vector(random, 1);
    const Mat3 G = random_matrix(random);
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      particles.velocity[i] = a + G * particles.position[i];
      particles.weight_rate[i] = 0;
    }
    const ParticleField field(particles, 0.5, 0);
    const Vec3 x = random_vector(random, 0.7), u = a + G * x;
    StrainResponse strain;
    const Jet jet = field.jet(x, strain);
    EXPECT_NEAR(jet.f_t + jet.g.dot(u), along(strain.f, G), 1e-12);
    const Vec3 g_rate = jet.g_t + jet.A * u + G.transpose() * jet.g;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(g_rate[c], along(strain.g[c], G), 1e-11);
    const Mat3 A_rate = jet.A_t + jet.C.contract(u) + G.transpose() * jet.A + jet.A * G;
    for (int c = 0, ce = 0; c < 3; ++c)
      for (int e = c; e < 3; ++e, ++ce) EXPECT_NEAR(A_rate(c, e), along(strain.A[ce], G), 1e-10);
  }
}

TEST(StrainResponse, ComesWithTheSameJet) {
  const ParticleField field(testing::random_particles(3, 40, 1), 0.5, 0);
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 x = random_vector(random, 1);
    StrainResponse strain;
    const Jet with = field.jet(x, strain), without = field.jet(x);
    EXPECT_EQ(with.f, without.f);
    EXPECT_EQ(with.A, without.A);
    EXPECT_EQ(with.A_t, without.A_t);
    for (const Mat3& m : strain.A) EXPECT_LT((m - m.transpose()).norm(), 1e-12 * m.norm());
  }
}

TEST(StrainResponse, IsZeroWhereTheMaterialCarriesTheLevelSets) {
  StrainResponse strain;
  strain.f.setOnes();
  testing::TorusField(1, 0.3).Field::jet(Vec3(1.3, 0, 0), strain);
  EXPECT_EQ(strain.f, Mat3(Mat3::Zero()));
  EXPECT_EQ(strain.A[5], Mat3(Mat3::Zero()));
}

}  // namespace
}  // namespace kappaflow
