#include "surface/field/particle_motion.h"

#include <gtest/gtest.h>

#include "core/errors.h"
#include "surface/field/curvature.h"
#include "tests/surface/field/random_particles.h"

namespace kappaflow {
namespace {

using testing::random_vector;

constexpr double kT0 = 0.3, kT1 = 0.5;

/// A particle whose path is a cubic polynomial of time, which Hermite interpolation reproduces.
struct CubicPath {
  explicit CubicPath(std::mt19937& random) : start(random_vector(random, 1)) {
    for (Vec3& c : coefficient) c = random_vector(random, 1);
  }
  Vec3 position(double t) const {
    return start + t * coefficient[0] + t * t * coefficient[1] + t * t * t * coefficient[2];
  }
  Vec3 velocity(double t) const {
    return coefficient[0] + 2 * t * coefficient[1] + 3 * t * t * coefficient[2];
  }
  Vec3 start;
  Vec3 coefficient[3];
};

std::vector<CubicPath> cubic_paths(unsigned seed, int count) {
  std::mt19937 random(seed);
  std::vector<CubicPath> paths;
  for (int i = 0; i < count; ++i) paths.emplace_back(random);
  return paths;
}

/// The particles at time t whose index `present` accepts; ids are 10, 20, 30, ...
template <class Present>
Particles at(const std::vector<CubicPath>& paths, double t, const Present& present) {
  Particles p;
  p.time = t;
  for (std::size_t i = 0; i < paths.size(); ++i)
    if (present(i)) {
      p.id.push_back(static_cast<std::int64_t>(10 * (i + 1)));
      p.position.push_back(paths[i].position(t));
      p.velocity.push_back(paths[i].velocity(t));
    }
  return p;
}

bool all(std::size_t) {
  return true;
}
bool not_every_fifth(std::size_t i) {
  return i % 5 != 0;
}
bool not_every_seventh(std::size_t i) {
  return i % 7 != 3;
}

void expect_same_jet(const Jet& a, const Jet& b, double tolerance) {
  EXPECT_NEAR(a.f, b.f, tolerance);
  EXPECT_LT((a.g - b.g).norm(), tolerance);
  EXPECT_LT((a.A - b.A).norm(), 10 * tolerance);
  EXPECT_NEAR(a.f_t, b.f_t, 10 * tolerance);
  EXPECT_LT((a.g_t - b.g_t).norm(), 10 * tolerance);
  EXPECT_LT((a.A_t - b.A_t).norm(), 100 * tolerance);
}

TEST(ParticleMotion, FollowsCubicPathsExactly) {
  const auto paths = cubic_paths(1, 30);
  ParticleMotion motion(at(paths, kT0, all), at(paths, kT1, all), {.sigma = 0.9, .threshold = 0.4});
  for (const double t : {kT0, 0.37, 0.4, kT1}) {
    const auto expected = particle_field(at(paths, t, all), {.sigma = 0.9, .threshold = 0.4});
    const auto field = motion.at(t);
    EXPECT_EQ(field->time(), t);
    std::mt19937 random(2);
    for (int i = 0; i < 20; ++i) {
      const Vec3 x = random_vector(random, 1.5);
      expect_same_jet(field->jet(x), expected->jet(x), 1e-12);
    }
  }
}

TEST(ParticleMotion, RampsParticlesThatAreAtOneEndOnly) {
  const auto paths = cubic_paths(3, 2);
  const Particles t0 = at(paths, kT0, [](std::size_t i) { return i == 0; });
  const Particles t1 = at(paths, kT1, [](std::size_t i) { return i == 1; });
  ParticleMotion motion(t0, t1, {.sigma = 2, .threshold = 0.1});
  const double t = 0.35, share = (t - kT0) / (kT1 - kT0), rate = 1 / (kT1 - kT0);
  const FieldParticles expected{
      .position = {t0.position[0] + (t - kT0) * t0.velocity[0], t1.position[0] - (kT1 - t) * t1.velocity[0]},
      .velocity = {t0.velocity[0], t1.velocity[0]},
      .sigma = {2, 2},
      .weight = {1 - share, share},
      .weight_rate = {-rate, rate}};
  const Vec3 x(0.2, 0.1, -0.3);
  expect_same_jet(motion.at(t)->jet(x), ParticleField(expected, 0.1, t).jet(x), 1e-12);
}

/// Every time derivative of the jet against central differences of the fields that the motion hands out.
TEST(ParticleMotion, TimeDerivativesAgreeWithFiniteDifferences) {
  const auto paths = cubic_paths(5, 60);
  const Particles t0 = at(paths, kT0, not_every_fifth), t1 = at(paths, kT1, not_every_seventh);
  const ParticleFieldOptions round{.sigma = 0.9, .threshold = 0.4};
  ParticleFieldOptions normalised = round, anisotropic = round;
  normalised.weights = WeightRule::normalised;
  anisotropic.kernels = Kernels::anisotropic;
  for (const ParticleFieldOptions& options : {round, normalised, anisotropic}) {
    ParticleMotion motion(t0, t1, options);
    constexpr double kTime = 0.38, kStep = 1e-6;
    const auto now = motion.at(kTime), before = motion.at(kTime - kStep), after = motion.at(kTime + kStep);
    std::mt19937 random(6);
    for (int i = 0; i < 50; ++i) {
      const Vec3 x = random_vector(random, 1.5);
      const Jet jet = now->jet(x), a = after->jet(x), b = before->jet(x);
      EXPECT_NEAR((a.f - b.f) / (2 * kStep), jet.f_t, 1e-7);
      EXPECT_LT(((a.g - b.g) / (2 * kStep) - jet.g_t).norm(), 1e-6);
      EXPECT_LT(((a.A - b.A) / (2 * kStep) - jet.A_t).norm(), 2e-4);  // the jump of A_t at a support's edge
      if (jet.g.norm() < 0.3) continue;
      const CurvatureJet c = curvature_jet(jet), c_a = curvature_jet(a), c_b = curvature_jet(b);
      EXPECT_NEAR((c_a.K - c_b.K) / (2 * kStep), c.K_t, 1e-4 * (1 + std::abs(c.K_t)));
      EXPECT_NEAR((c_a.H - c_b.H) / (2 * kStep), c.H_t, 1e-4 * (1 + std::abs(c.H_t)));
    }
  }
}

// A step's last field and the next step's first are the same surface, so a tracker sees no jump.
TEST(ParticleMotion, IsContinuousFromStepToStep) {
  const auto paths = cubic_paths(7, 60);
  const Particles t0 = at(paths, 0.2, all), t1 = at(paths, 0.3, not_every_fifth),
                  t2 = at(paths, 0.4, not_every_seventh);
  for (const Kernels kernels : {Kernels::round, Kernels::anisotropic}) {
    const ParticleFieldOptions options{
        .sigma = 0.9, .weights = WeightRule::normalised, .threshold = 0.4, .kernels = kernels};
    ParticleMotion first(t0, t1, options), second(t1, t2, options),
        in_turn(t1, t2, options, first.shapes_t1());
    std::mt19937 random(8);
    for (int i = 0; i < 30; ++i) {
      const Vec3 x = random_vector(random, 1.5);
      const ValueAndGradient a = first.at(0.3)->value_and_gradient(x),
                             b = second.at(0.3)->value_and_gradient(x);
      EXPECT_NEAR(a.f, b.f, 1e-13);
      EXPECT_LT((a.g - b.g).norm(), 1e-12);
      EXPECT_EQ(second.at(0.36)->jet(x).A_t, in_turn.at(0.36)->jet(x).A_t);
    }
  }
}

TEST(ParticleMotion, SharesFieldsOfTheSameTime) {
  const auto paths = cubic_paths(9, 3);
  ParticleMotion motion(at(paths, kT0, all), at(paths, kT1, all), {.sigma = 1, .threshold = 0.4});
  EXPECT_EQ(motion.at(0.4), motion.at(0.4));
  EXPECT_NE(motion.at(0.4), motion.at(0.45));
}

TEST(ParticleMotion, RefusesWhatMakesNoSense) {
  const auto paths = cubic_paths(9, 3);
  const Particles t0 = at(paths, kT0, all), t1 = at(paths, kT1, all);
  EXPECT_THROW(ParticleMotion(t1, t0, {.sigma = 1, .threshold = 0.4}), InvalidInput);
  EXPECT_THROW(ParticleMotion(t0, t1, {.sigma = 0, .threshold = 0.4}), InvalidInput);
  EXPECT_THROW(ParticleMotion(t0, t1, {.sigma = 1, .threshold = 0}), InvalidInput);
  Particles unsorted = t1;
  std::swap(unsorted.id[0], unsorted.id[1]);
  EXPECT_THROW(ParticleMotion(t0, unsorted, {.sigma = 1, .threshold = 0.4}), InvalidInput);
  ParticleMotion motion(t0, t1, {.sigma = 1, .threshold = 0.4});
  EXPECT_THROW(motion.at(0.2), InvalidInput);
  EXPECT_THROW(motion.at(0.6), InvalidInput);
}

// Clouds: nothing is paired, nothing has a velocity, and f is the mean of the two fields.
TEST(PointClouds, FieldIsTheMeanOfBothEnds) {
  std::mt19937 random(5);
  Particles before{kT0, {}, {}, {}}, after{kT1, {}, {}, {}};
  for (int i = 0; i < 40; ++i) {
    before.id.push_back(i);
    after.id.push_back(40 + i);
    before.position.push_back(random_vector(random, 0.5));
    after.position.push_back(before.position.back() + random_vector(random, 0.02));
  }
  before.velocity.assign(40, Vec3::Zero());
  after.velocity = before.velocity;
  const ParticleFieldOptions options{
      .sigma = 0.6, .weights = WeightRule::uniform, .threshold = 0.5, .cloud_speed = 7};
  ParticleMotion motion(before, after, options);
  const auto f0 = particle_field(before, options), f1 = particle_field(after, options);
  const auto middle = motion.at(0.25 * kT1 + 0.75 * kT0);
  for (int i = 0; i < 20; ++i) {
    const Vec3 x = random_vector(random, 0.4);
    const Jet jet = middle->jet(x), a = f0->jet(x), b = f1->jet(x);
    EXPECT_NEAR(jet.f, 0.75 * a.f + 0.25 * b.f, 1e-13);
    EXPECT_NEAR(jet.f_t, (b.f - a.f) / (kT1 - kT0), 1e-11);
    EXPECT_LT((jet.g_t - (b.g - a.g) / (kT1 - kT0)).norm(), 1e-10);
    EXPECT_LT((jet.A_t - (b.A - a.A) / (kT1 - kT0)).norm(), 1e-9);
    EXPECT_EQ(jet.fastest_in_reach, 7) << "what is not known does not limit";
    EXPECT_EQ(middle->material_velocity(x), std::nullopt);
  }
  EXPECT_EQ(middle->fastest_speed(), 7);
}

TEST(MotionPart, IsTheWholeForAWhile) {
  const Particles before{kT0, {1}, {Vec3::Zero()}, {Vec3::Zero()}};
  Particles after = before;
  after.time = kT1;
  after.position[0].x() = 0.1;
  ParticleMotion whole(before, after, {.sigma = 1, .weights = WeightRule::uniform, .threshold = 0.5});
  MotionPart part(whole, 0.35, 0.4);
  EXPECT_EQ(part.t0(), 0.35);
  EXPECT_EQ(part.t1(), 0.4);
  const auto field = part.at(0.4);
  EXPECT_EQ(field, whole.at(0.4));
  part.at(0.35);
  whole.forget_before(0.4);
  EXPECT_EQ(whole.at(0.4), field) << "still there";
  EXPECT_THROW(MotionPart(whole, 0.2, 0.4), InvalidInput);
  EXPECT_THROW(MotionPart(whole, 0.4, 0.4), InvalidInput);
  EXPECT_THROW(MotionPart(whole, 0.4, 0.6), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
