#include "surface/field/anisotropic_field.h"

#include <gtest/gtest.h>

#include <set>

#include "core/errors.h"
#include "tests/surface/field/jet_error.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::largest_scaled_error;
using testing::random_vector;

/// Particles for kernels: what a jet's length scale and speed are of.
FieldParticles particles_of(const FieldKernels& kernels) {
  const std::size_t n = kernels.size();
  return {.position = kernels.center,
          .velocity = kernels.velocity,
          .sigma = std::vector<double>(n, 1.0),
          .weight = kernels.weight,
          .weight_rate = kernels.weight_rate};
}

/// Round kernels of the same particles.
FieldKernels round_kernels(const FieldParticles& p) {
  FieldKernels kernels{.center = p.position,
                       .velocity = p.velocity,
                       .shape = {},
                       .shape_rate = std::vector<SymmetricMatrix>(p.position.size(), SymmetricMatrix{}),
                       .weight = p.weight,
                       .weight_rate = p.weight_rate};
  for (const double sigma : p.sigma) kernels.shape.push_back(symmetric(Mat3::Identity() / (sigma * sigma)));
  return kernels;
}

struct RandomKernels {
  FieldParticles particles;
  FieldKernels kernels;
};

/// Ellipsoids with radii of 0.5 to 1.5, turned and moving at random.
RandomKernels random_kernels(unsigned seed, int count, double half_width) {
  RandomKernels result{testing::random_particles(seed, count, half_width), {}};
  result.kernels = round_kernels(result.particles);
  std::mt19937 random(seed + 1);
  for (SymmetricMatrix& shape : result.kernels.shape) {
    Mat3 root = Mat3::Identity();
    for (int a = 0; a < 3; ++a) root.col(a) += random_vector(random, 0.4);
    shape = symmetric(root * root.transpose() + 0.4 * Mat3::Identity());
  }
  for (SymmetricMatrix& rate : result.kernels.shape_rate) {
    const Vec3 p = random_vector(random, 1), q = random_vector(random, 1);
    rate = {p[0], p[1], p[2], q[0], q[1], q[2]};
  }
  return result;
}

TEST(AnisotropicFieldJet, AgreesWithTheReferenceTable) {
  double worst = 0;
  for (const testing::KernelCase& c : testing::read_kernel_cases()) {
    const AnisotropicField field(particles_of(c.kernels), c.kernels, c.threshold, 0);
    worst = std::max(worst, largest_scaled_error(field.jet(c.x), c.jet));
  }
  EXPECT_LT(worst, 1e-13);
}

// 50 particles: few hits; 4000 in the same cube: more hits than are worked on at once.
TEST(AnisotropicFieldJet, IsThatOfEquation12ForRoundKernels) {
  for (const int count : {0, 1, 50, 4000}) {
    const FieldParticles particles = testing::random_particles(11, count, 1.5);
    const ParticleField round(particles, 0.3, 0);
    const AnisotropicField field(particles, round_kernels(particles), 0.3, 0);
    std::mt19937 random(12);
    for (int i = 0; i < 60; ++i) {
      const Vec3 x = random_vector(random, 3);
      const Jet expected = round.jet(x), jet = field.jet(x);
      ASSERT_LT(largest_scaled_error(jet, expected), 1e-13 * std::max(1, count / 20)) << count;
      ASSERT_NEAR(jet.length_scale, expected.length_scale, 1e-12);
      ASSERT_NEAR(jet.fastest_in_reach, expected.fastest_in_reach, 1e-14);
    }
  }
}

// Kernels that deform as the material does in an affine motion u = u_0 + G x: it carries f, Df/Dt = 0, and
// Dg/Dt = -G^T g.
TEST(AnisotropicFieldJet, IsCarriedByAnAffineMotion) {
  std::mt19937 random(8);
  RandomKernels r = random_kernels(21, 200, 1.5);
  Mat3 G;
  for (int a = 0; a < 3; ++a) G.col(a) = random_vector(random, 1);
  const Vec3 u_0 = random_vector(random, 1);
  const auto u = [&](const Vec3& x) { return Vec3(u_0 + G * x); };
  for (std::size_t i = 0; i < r.kernels.size(); ++i) {
    const Mat3 M = full(r.kernels.shape[i]);
    r.kernels.velocity[i] = u(r.kernels.center[i]);
    r.kernels.shape_rate[i] = symmetric(Mat3(-(G.transpose() * M + M * G)));
    r.kernels.weight_rate[i] = 0;
  }
  const AnisotropicField field(r.particles, r.kernels, 0.3, 0);
  double speeds = 0;
  for (int k = 0; k < 100; ++k) {
    const Vec3 x = random_vector(random, 1.5);
    const Jet jet = field.jet(x);
    speeds = std::max(speeds, std::abs(jet.f_t));
    EXPECT_NEAR(jet.f_t + jet.g.dot(u(x)), 0, 1e-11 * jet.g.norm());
    EXPECT_LT((jet.g_t + jet.A * u(x) + G.transpose() * jet.g).norm(), 1e-11 * (jet.g.norm() + jet.A.norm()));
  }
  EXPECT_GT(speeds, 1) << "nothing moved";
}

TEST(AnisotropicField, HasOneValueAndGradientHoweverItIsAsked) {
  const auto [particles, kernels] = random_kernels(21, 300, 2);
  const AnisotropicField field(particles, kernels, 0.3, 0);
  std::mt19937 random(22);
  for (int i = 0; i < 200; ++i) {
    const Vec3 x = random_vector(random, 3);
    const Jet jet = field.jet(x);
    const ValueAndGradient at = field.value_and_gradient(x);
    ASSERT_NEAR(at.f, jet.f, 1e-12);
    ASSERT_LT((at.g - jet.g).norm(), 1e-12);
    const Jet low = field.first_order_jet(x);
    ASSERT_NEAR(low.f, jet.f, 1e-12);
    ASSERT_NEAR(low.f_t, jet.f_t, 1e-12 * (1 + std::abs(jet.f_t)));
    ASSERT_LT((low.g - jet.g).norm(), 1e-12);
    ASSERT_EQ(low.length_scale, jet.length_scale);
    ASSERT_EQ(low.fastest_in_reach, jet.fastest_in_reach);
  }
}

TEST(AnisotropicField, IsSampledAsItIsEvaluated) {
  const auto [particles, kernels] = random_kernels(31, 120, 2);
  const AnisotropicField field(particles, kernels, 0.3, 0);
  SampledField samples;
  samples.origin = Vec3(-4, -4, -4);
  samples.spacing = 0.31;
  samples.dims = {27, 26, 25};
  samples.first_plane = 2;
  SampledField by_point = samples;
  field.sample(samples);
  field.Field::sample(by_point);
  for (std::size_t i = 0; i < samples.value.size(); ++i)
    ASSERT_NEAR(samples.value[i], by_point.value[i], 2e-6f * (1 + std::abs(by_point.value[i])));
}

TEST(AnisotropicField, IsPositiveWithinItsBoundsAndItsOccupiedCubesOnly) {
  constexpr int kCells = 4;
  const auto [particles, kernels] = random_kernels(41, 40, 6);
  const AnisotropicField field(particles, kernels, 0.3, 0);
  SampledField lattice;
  lattice.spacing = 0.25;
  lattice.origin = field.bounds().lower - Vec3::Constant(1);
  const Vec3 size = field.bounds().upper - field.bounds().lower + Vec3::Constant(2);
  for (int a = 0; a < 3; ++a) lattice.dims[a] = static_cast<int>(size[a] / lattice.spacing) + 2;
  const auto cubes = field.occupied_cubes(lattice, kCells).value();
  EXPECT_TRUE(std::ranges::is_sorted(cubes, {}, [](const auto& c) { return std::array{c[2], c[1], c[0]}; }));
  const std::set<std::array<int, 3>> occupied(cubes.begin(), cubes.end());
  int inside = 0;
  for (int k = 0; k < lattice.dims[2] - 1; ++k)
    for (int j = 0; j < lattice.dims[1] - 1; ++j)
      for (int i = 0; i < lattice.dims[0] - 1; ++i) {
        const Vec3 x = lattice.origin + lattice.spacing * Vec3(i, j, k);
        if (field.value_and_gradient(x).f <= 0) continue;
        ++inside;
        ASSERT_TRUE(occupied.contains({i / kCells, j / kCells, k / kCells})) << x.transpose();
        ASSERT_TRUE((x.array() >= field.bounds().lower.array()).all() &&
                    (x.array() <= field.bounds().upper.array()).all());
      }
  EXPECT_GT(inside, 100);
}

TEST(AnisotropicField, LeavesOutWhatIsFarAwayAndHasNoSurface) {
  auto [particles, kernels] = random_kernels(51, 60, 1);
  const AnisotropicField alone(particles, kernels, 1.9, 0);
  particles.position.emplace_back(1e9, 0, 0);
  particles.velocity.emplace_back(Vec3::Zero());
  particles.sigma.push_back(1);
  particles.weight.push_back(1);
  particles.weight_rate.push_back(0);
  kernels.center.push_back(particles.position.back());
  kernels.velocity.emplace_back(Vec3::Zero());
  kernels.shape.push_back(symmetric(Mat3::Identity()));
  kernels.shape_rate.push_back(SymmetricMatrix{});
  kernels.weight.push_back(1);
  kernels.weight_rate.push_back(0);
  const AnisotropicField field(particles, kernels, 1.9, 0);
  EXPECT_EQ(field.bounds().upper, alone.bounds().upper);
  const Vec3 x(0.3, -0.2, 0.1);
  EXPECT_EQ(field.jet(x).f, alone.jet(x).f);
}

// What moves along the surface is read from round kernels, and so is the velocity of the material.
TEST(AnisotropicField, HasEquation12AsItsPattern) {
  const auto [particles, kernels] = random_kernels(61, 60, 1);
  const AnisotropicField field(particles, kernels, 0.3, 0);
  const ParticleField round(particles, 0.3, 0);
  const Vec3 x(0.3, -0.2, 0.1);
  EXPECT_EQ(field.pattern().jet(x).A_t, round.jet(x).A_t);
  EXPECT_EQ(field.material_velocity(x).value(), round.material_velocity(x).value());
  EXPECT_EQ(field.length_scale(), round.length_scale());
  EXPECT_EQ(field.fastest_speed(), round.fastest_speed());
  EXPECT_EQ(&round.pattern(), &round) << "a field is its own pattern";
}

// A flat kernel reaches further than the round one of its particle.
TEST(AnisotropicField, KnowsTheMaterialsVelocityWhereverItIsPositive) {
  const FieldParticles particles{.position = {Vec3::Zero()},
                                 .velocity = {Vec3(1, 2, 3)},
                                 .sigma = {1},
                                 .weight = {1},
                                 .weight_rate = {0}};
  FieldKernels kernels = round_kernels(particles);
  kernels.velocity[0] = Vec3(7, 7, 7);  // of its centre
  kernels.shape[0] = {0.25, 0, 0, 0.25, 0, 4};
  const AnisotropicField field(particles, kernels, 0.1, 0);
  EXPECT_FALSE(field.pattern().material_velocity(Vec3(1.2, 0, 0)).has_value());
  EXPECT_LT((field.material_velocity(Vec3(1.2, 0, 0)).value() - Vec3(1, 2, 3)).norm(), 1e-14);
  EXPECT_FALSE(field.material_velocity(Vec3(2.1, 0, 0)).has_value());
}

TEST(AnisotropicField, RefusesKernelsThatMakeNoSense) {
  const auto good = random_kernels(71, 3, 1);
  const auto expect_refused = [&](auto&& spoil) {
    auto bad = good;
    spoil(bad.kernels);
    EXPECT_THROW(AnisotropicField(bad.particles, bad.kernels, 0.3, 0), InvalidInput);
  };
  EXPECT_NO_THROW(AnisotropicField(good.particles, good.kernels, 0.3, 0));
  expect_refused([](FieldKernels& k) { k.center.pop_back(); });
  expect_refused([](FieldKernels& k) { k.shape_rate.pop_back(); });
  expect_refused([](FieldKernels& k) { k.shape[1] = {1, 0, 0, 1, 0, -1}; });
  expect_refused([](FieldKernels& k) { k.shape[1] = {1, 2, 0, 1, 0, 1}; });
  expect_refused([](FieldKernels& k) { k.shape[1] = SymmetricMatrix{}; });
  expect_refused([](FieldKernels& k) { k.weight[2] = std::nan(""); });
  expect_refused([](FieldKernels& k) { k.shape_rate[2][4] = kInfinity; });
}

}  // namespace
}  // namespace kappaflow
