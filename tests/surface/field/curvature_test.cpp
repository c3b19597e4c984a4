#include "surface/field/curvature.h"

#include <gtest/gtest.h>

#include "tests/surface/field/random_particles.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::random_particles;
using testing::random_vector;

/// Largest difference, each over the size of the expected number or 1 (lengths here are about 1 m, speeds 1
/// m/s).
double scaled_error(const CurvatureJet& c, const CurvatureJet& expected) {
  const auto error = [](double difference, double size) { return difference / std::max(1.0, size); };
  return std::max({error(std::abs(c.K - expected.K), std::abs(expected.K)),
                   error(std::abs(c.H - expected.H), std::abs(expected.H)),
                   error((c.grad_K - expected.grad_K).norm(), expected.grad_K.norm()),
                   error((c.grad_H - expected.grad_H).norm(), expected.grad_H.norm()),
                   error(std::abs(c.K_t - expected.K_t), std::abs(expected.K_t)),
                   error(std::abs(c.H_t - expected.H_t), std::abs(expected.H_t))});
}

TEST(Curvature, AgreesWithTheReferenceTable) {
  double worst_from_particles = 0, worst_from_jet = 0;
  for (const testing::JetCase& c : testing::read_jet_cases()) {
    const Jet jet = ParticleField(c.particles, c.threshold, 0).jet(c.x);
    worst_from_particles = std::max(worst_from_particles, scaled_error(curvature_jet(jet), c.curvature));
    worst_from_jet = std::max(worst_from_jet, scaled_error(curvature_jet(c.jet), c.curvature));
  }
  EXPECT_LT(worst_from_particles, 4e-14);
  EXPECT_LT(worst_from_jet, 4e-14);
}

TEST(Curvature, OfASphereIsOneOverTheRadiusAndItsSquare) {
  const EllipsoidField sphere(Vec3(1, 2, 3), Mat3::Identity(), Vec3::Constant(0.5), Vec3(1, -1, 2));
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    const Vec3 n = random_vector(random, 1).normalized(), x = Vec3(1, 2, 3) + 0.5 * n;
    const CurvatureJet c = curvature_jet(sphere.jet(x));
    EXPECT_NEAR(c.H, 2, 1e-13);
    EXPECT_NEAR(c.K, 4, 1e-13);
    // H = 1/r on the level sets, which move with the sphere.
    EXPECT_LT((c.grad_H + 4 * n).norm(), 1e-12);
    EXPECT_NEAR(c.H_t, 4 * n.dot(Vec3(1, -1, 2)), 1e-12);
    EXPECT_NEAR(c.K_t, 16 * n.dot(Vec3(1, -1, 2)), 1e-12);
  }
}

TEST(Curvature, OfAnEllipsoidAtItsVertices) {
  const EllipsoidField ellipsoid(Vec3::Zero(), Mat3::Identity(), Vec3(1, 2, 3));
  // At (a, 0, 0) the principal curvatures are a/b^2 and a/c^2.
  const CurvatureJet c = curvature_jet(ellipsoid.jet(Vec3(1, 0, 0)));
  EXPECT_NEAR(c.K, 1.0 / 36, 1e-15);
  EXPECT_NEAR(c.H, 0.5 * (1.0 / 4 + 1.0 / 9), 1e-15);
}

TEST(Curvature, GradientsAgreeWithFiniteDifferences) {
  const ParticleField field(random_particles(5, 30, 1.0), 0.3, 0);
  std::mt19937 random(6);
  constexpr double kStep = 1e-5;
  int tested = 0;
  while (tested < 40) {
    const Vec3 x = random_vector(random, 1.5);
    if (field.jet(x).g.norm() < 1) continue;
    ++tested;
    const CurvatureJet c = curvature_jet(field.jet(x));
    for (int a = 0; a < 3; ++a) {
      const CurvatureJet ahead = curvature_jet(field.jet(x + kStep * Vec3::Unit(a))),
                         behind = curvature_jet(field.jet(x - kStep * Vec3::Unit(a)));
      EXPECT_NEAR((ahead.K - behind.K) / (2 * kStep), c.grad_K[a], 1e-3 * (1 + c.grad_K.norm()));
      EXPECT_NEAR((ahead.H - behind.H) / (2 * kStep), c.grad_H[a], 1e-3 * (1 + c.grad_H.norm()));
    }
  }
}

}  // namespace
}  // namespace kappaflow
