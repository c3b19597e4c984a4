#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/dense.h"
#include "tests/surface/field/jet_error.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::JetCase;
using testing::largest_scaled_error;
using testing::random_particles;
using testing::random_vector;
using testing::scaled_error;

TEST(ParticleFieldJet, AgreesWithTheReferenceTable) {
  double worst = 0;
  for (const JetCase& c : testing::read_jet_cases()) {
    const Jet jet = ParticleField(c.particles, c.threshold, 0).jet(c.x);
    worst = std::max(worst, largest_scaled_error(jet, c.jet));
  }
  EXPECT_LT(worst, 4e-14);
}

/// Eq. 12 differentiated with indices, particle by particle: slow and plain.
Jet direct_jet(const FieldParticles& p, double threshold, const Vec3& x) {
  Jet jet;
  jet.f = -threshold;
  double sum = 0;
  double third[3][3][3] = {};
  for (std::size_t i = 0; i < p.position.size(); ++i) {
    const Vec3 d = x - p.position[i], v = p.velocity[i];
    const double sigma2 = p.sigma[i] * p.sigma[i], s = d.squaredNorm() / sigma2, w = p.weight[i],
                 w_t = p.weight_rate[i];
    if (s >= 1) continue;
    const double phi = std::pow(1 - s, 3), phi1 = -3 * (1 - s) * (1 - s), phi2 = 6 * (1 - s), phi3 = -6;
    const Vec3 s_a = 2 / sigma2 * d;
    const Mat3 s_ab = 2 / sigma2 * Mat3::Identity();
    const Vec3 grad = phi1 * s_a;
    const Mat3 hessian = phi2 * s_a * s_a.transpose() + phi1 * s_ab;
    Mat3 hessian_along_v = Mat3::Zero();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        for (int c = 0; c < 3; ++c) {
          const double abc = phi3 * s_a[a] * s_a[b] * s_a[c] +
                             phi2 * (s_ab(a, b) * s_a[c] + s_ab(a, c) * s_a[b] + s_ab(b, c) * s_a[a]);
          third[a][b][c] += w * abc;
          hessian_along_v(a, b) += abc * v[c];
        }
    sum += w * phi;
    jet.length_scale += w * phi * p.sigma[i];
    jet.fastest_in_reach = std::max(jet.fastest_in_reach, v.norm());
    jet.g += w * grad;
    jet.A += w * hessian;
    jet.f_t += w_t * phi - w * v.dot(grad);
    jet.g_t += w_t * grad - w * hessian * v;
    jet.A_t += w_t * hessian - w * hessian_along_v;
  }
  jet.f += sum;
  if (sum > 0) jet.length_scale /= sum;
  jet.C = {third[0][0][0], third[0][0][1], third[0][0][2], third[0][1][1], third[0][1][2],
           third[0][2][2], third[1][1][1], third[1][1][2], third[1][2][2], third[2][2][2]};
  return jet;
}

// 50 particles: few hits; 4000 in the same cube: more hits than are worked on at once.
TEST(ParticleFieldJet, AgreesWithTheDirectSumOverAllParticles) {
  for (const int count : {0, 1, 50, 4000}) {
    const FieldParticles particles = random_particles(11, count, 1.5);
    const ParticleField field(particles, 0.3, 0);
    std::mt19937 random(12);
    for (int i = 0; i < 60; ++i) {
      const Vec3 x = random_vector(random, 3);
      const Jet expected = direct_jet(particles, 0.3, x), jet = field.jet(x);
      const double tolerance = 1e-14 * std::max(10, count);  // the terms of the sum are of size 1
      ASSERT_LT(largest_scaled_error(jet, expected), tolerance) << count << " particles at " << x.transpose();
      ASSERT_NEAR(jet.length_scale, expected.length_scale, 1e-13);
      ASSERT_NEAR(jet.fastest_in_reach, expected.fastest_in_reach, 1e-14);
      const ValueAndGradient short_jet = field.value_and_gradient(x);
      ASSERT_NEAR(short_jet.f, expected.f, tolerance);
      ASSERT_LT(scaled_error(short_jet.g, expected.g), tolerance);
      const auto [low, material] = field.moving_point(x);
      for (const Jet& first_order : {field.first_order_jet(x), low}) {
        ASSERT_NEAR(first_order.f, expected.f, tolerance);
        ASSERT_NEAR(first_order.f_t, expected.f_t, tolerance * (1 + std::abs(expected.f_t)));
        ASSERT_LT(scaled_error(first_order.g, expected.g), tolerance);
        ASSERT_NEAR(first_order.length_scale, expected.length_scale, 1e-13);
        ASSERT_NEAR(first_order.fastest_in_reach, expected.fastest_in_reach, 1e-14);
      }
      const auto alone = field.material_velocity(x);
      ASSERT_EQ(material.has_value(), alone.has_value());
      if (material) {
        ASSERT_LT((*material - *alone).norm(), 1e-12);
      }
    }
  }
}

/// Fourth-order central difference of a function of one number.
template <class F>
auto derivative(const F& f, double h) {
  return ((8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h)).eval();
}

TEST(ParticleFieldJet, SpatialDerivativesAgreeWithFiniteDifferences) {
  const FieldParticles particles = random_particles(21, 40, 1.5);
  const ParticleField field(particles, 0.3, 0);
  constexpr double kStep = 1e-3;
  const auto far_from_support_edges = [&](const Vec3& x) {  // the third derivatives jump there
    for (std::size_t i = 0; i < particles.position.size(); ++i)
      if (std::abs((x - particles.position[i]).norm() - particles.sigma[i]) < 3 * kStep) return false;
    return true;
  };
  std::mt19937 random(22);
  int tested = 0;
  while (tested < 50) {
    const Vec3 x = random_vector(random, 1.2);
    if (!far_from_support_edges(x)) continue;
    ++tested;
    const Jet jet = field.jet(x);
    for (int a = 0; a < 3; ++a) {
      const auto at = [&](double h) { return field.jet(x + h * Vec3::Unit(a)); };
      const auto f = [&](double h) { return Eigen::Array<double, 1, 1>(at(h).f); };
      EXPECT_NEAR(derivative(f, kStep)[0], jet.g[a], 1e-9);
      EXPECT_LT((derivative([&](double h) { return at(h).g; }, kStep) - jet.A.col(a)).norm(), 1e-8);
      const Mat3 third = derivative([&](double h) { return at(h).A; }, kStep);
      EXPECT_LT((third - jet.C.contract(Vec3::Unit(a))).norm(), 1e-6);
    }
  }
}

TEST(ParticleFieldJet, IsTwiceContinuouslyDifferentiableAtTheSupportsEdge) {
  FieldParticles lone = random_particles(31, 1, 0.5);
  const double sigma = lone.sigma[0], w = lone.weight[0];
  const Vec3 direction = Vec3(1, 2, -2) / 3;
  const ParticleField field(lone, 0.3, 0);
  for (const double inside : {1e-3, 1e-6, 1e-9}) {
    const Jet jet = field.jet(lone.position[0] + sigma * (1 - inside) * direction);
    EXPECT_NEAR(jet.f, -0.3, w * std::pow(2 * inside, 3));
    EXPECT_LT(jet.g.norm(), 25 * w * inside * inside / sigma);
    EXPECT_LT(jet.A.norm(), 50 * w * inside / (sigma * sigma));
    // The radial third derivative tends to phi''' (2/sigma)^3 = -48/sigma^3 from within, and is zero without:
    // (72 r - 120 r^3)/sigma^3.
    const double radial = direction.dot(jet.C.contract(direction) * direction);
    EXPECT_NEAR(radial * std::pow(sigma, 3) / w, -48, 300 * inside);
  }
  const Jet outside = field.jet(lone.position[0] + sigma * (1 + 1e-9) * direction);
  EXPECT_EQ(outside.f, -0.3);
  EXPECT_EQ(outside.g, Vec3(0, 0, 0));
  EXPECT_EQ(outside.C.xxx, 0);
  EXPECT_EQ(outside.length_scale, 0);
}

TEST(ParticleField, KnowsItsBoundsScalesAndSpeeds) {
  FieldParticles p = random_particles(41, 30, 2);
  const ParticleField field(p, 0.3, 1.5);
  EXPECT_EQ(field.time(), 1.5);
  EXPECT_EQ(field.length_scale(), *std::min_element(p.sigma.begin(), p.sigma.end()));
  double fastest = 0;
  for (const Vec3& v : p.velocity) fastest = std::max(fastest, v.norm());
  EXPECT_DOUBLE_EQ(field.fastest_speed(), fastest);
  const Bounds bounds = field.bounds();
  for (std::size_t i = 0; i < p.position.size(); ++i)
    for (int a = 0; a < 3; ++a) {
      EXPECT_LE(bounds.lower[a], p.position[i][a] - p.sigma[i]);
      EXPECT_GE(bounds.upper[a], p.position[i][a] + p.sigma[i]);
    }
  EXPECT_TRUE(ParticleField({}, 0.3, 0).bounds().empty());
}

TEST(ParticleField, RefusesArraysThatDoNotFit) {
  FieldParticles p = random_particles(1, 3, 1);
  p.weight.pop_back();
  EXPECT_THROW(ParticleField(p, 0.3, 0), InvalidInput);
  p = random_particles(1, 3, 1);
  p.sigma[1] = 0;
  EXPECT_THROW(ParticleField(p, 0.3, 0), InvalidInput);
  p = random_particles(1, 3, 1);
  p.position[2][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ParticleField(p, 0.3, 0), InvalidInput);
}

TEST(MaterialVelocity, IsExactForUniformMotionAndConvergesForAffineOnes) {
  FieldParticles p = random_particles(51, 400, 1.5);
  std::fill(p.sigma.begin(), p.sigma.end(), 1.0);
  const Vec3 velocity(1, -2, 0.5);
  testing::set_velocities(p, [&](const Vec3&) { return velocity; });
  const ParticleField uniform(p, 0.3, 0);
  Mat3 gradient;
  gradient << 0, -1, 0.3, 1, 0, 0.2, -0.3, -0.2, 0.4;
  testing::set_velocities(p, [&](const Vec3& x) { return Vec3(velocity + gradient * x); });
  const ParticleField affine(p, 0.3, 0);
  std::mt19937 random(52);
  for (int i = 0; i < 50; ++i) {
    const Vec3 x = random_vector(random, 1);
    EXPECT_LT((*uniform.material_velocity(x) - velocity).norm(), 1e-13);
    // The ridge leaves a share of the particles' mean offset times the gradient.
    EXPECT_LT((*affine.material_velocity(x) - velocity - gradient * x).norm(), 0.005);
  }
  EXPECT_FALSE(uniform.material_velocity(Vec3(10, 0, 0)).has_value());
}

/// The definition, written out: the normal equations of weighted least squares with the ridge.
TEST(MaterialVelocity, SolvesTheRidgedLeastSquaresProblem) {
  FieldParticles p = random_particles(61, 60, 1.2);
  std::fill(p.sigma.begin(), p.sigma.end(), 0.9);
  const ParticleField field(p, 0.3, 0);
  const Vec3 x(0.1, -0.2, 0.3);
  Eigen::MatrixXd rows(63, 4), rhs(63, 3);
  rows.setZero();
  rhs.setZero();
  double sum = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 r = (p.position[i] - x) / 0.9;
    const double kernel = std::pow(std::max(0.0, 1 - r.squaredNorm()), 3);
    sum += kernel;
    rows.row(i) = std::sqrt(kernel) * Eigen::RowVector4d(1, r[0], r[1], r[2]);
    rhs.row(i) = std::sqrt(kernel) * p.velocity[i].transpose();
  }
  for (int a = 0; a < 3; ++a) rows(60 + a, 1 + a) = std::sqrt(0.001 * sum);
  const Vec3 expected = testing::least_squares(rows, rhs).row(0).transpose();
  EXPECT_LT((*field.material_velocity(x) - expected).norm(), 1e-12);
}

}  // namespace
}  // namespace kappaflow
