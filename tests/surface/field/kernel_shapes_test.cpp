// Kernels that follow the liquid: how smooth they make a surface, and that they leave it where it was.
#include "surface/field/kernel_shapes.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <numbers>

#include "core/errors.h"
#include "surface/field/particle_motion.h"
#include "tests/surface/field/random_particles.h"

namespace kappaflow {
namespace {

// Particles one apart.
constexpr double kSigma = 2.5;
constexpr double kThreshold =
    0.5 * 64 * std::numbers::pi / 315 * kSigma * kSigma * kSigma;  // half the inside

FieldParticles at_rest(const std::vector<Vec3>& position) {
  const std::size_t n = position.size();
  return {.position = position,
          .velocity = std::vector<Vec3>(n, Vec3::Zero()),
          .sigma = std::vector<double>(n, kSigma),
          .weight = std::vector<double>(n, 1.0),
          .weight_rate = std::vector<double>(n, 0.0)};
}

/// The points of a lattice in |x| <= half.
std::vector<Vec3> box(const Vec3& half) {
  std::vector<Vec3> x;
  const Vec3 last = (2 * half).array().floor();
  for (int i = 0; i <= last[0]; ++i)
    for (int j = 0; j <= last[1]; ++j)
      for (int k = 0; k <= last[2]; ++k) x.push_back(Vec3(i, j, k) - 0.5 * last);
  return x;
}

std::vector<Vec3> ball(double radius) {
  std::vector<Vec3> x = box(Vec3::Constant(std::floor(radius) + 0.5));
  std::erase_if(x, [&](const Vec3& p) { return p.norm() > radius; });
  return x;
}

std::vector<Vec3> shaken(std::vector<Vec3> x, double by) {
  std::mt19937 random(4);
  for (Vec3& p : x) p += testing::random_vector(random, by);
  return x;
}

std::shared_ptr<const Field> field_of(const std::vector<Vec3>& position, Kernels kernels) {
  return particle_field(at_rest(position), kernels, kThreshold, 0);
}

/// How a surface lies along rays.
struct Waviness {
  double height = 0, normals = 0;  ///< RMS of the distance less its mean, and of the angle to the ray [rad]
  double mean = 0;                 ///< distance from where the rays start
  double mean_cube = 0;
};

/// Of rays from `origins` along `directions`, whose surface is near the distance `start`.
Waviness waviness(const Field& field, const std::vector<Vec3>& origins, const std::vector<Vec3>& directions,
                  double start) {
  Waviness result;
  double squares = 0;
  const double n = static_cast<double>(origins.size());
  for (std::size_t i = 0; i < origins.size(); ++i) {
    double r = start;
    ValueAndGradient at;
    for (int step = 0; step < 20; ++step) {
      at = field.value_and_gradient(origins[i] + r * directions[i]);
      r += std::clamp(-at.f / at.g.dot(directions[i]), -0.3, 0.3);
    }
    const double angle = std::acos(std::min(1.0, -at.g.normalized().dot(directions[i])));
    result.mean += r / n;
    result.mean_cube += r * r * r / n;
    squares += r * r / n;
    result.normals += angle * angle / n;
  }
  result.height = std::sqrt(std::max(0.0, squares - result.mean * result.mean));
  result.normals = std::sqrt(result.normals);
  return result;
}

std::vector<Vec3> random_directions(int count) {
  std::mt19937 random(9);
  std::vector<Vec3> directions;
  while (static_cast<int>(directions.size()) < count)
    if (const Vec3 d = testing::random_vector(random, 1); d.norm() < 1 && d.norm() > 0.1)
      directions.push_back(d.normalized());
  return directions;
}

Waviness of_ball(Kernels kernels, double radius) {
  const std::vector<Vec3> rays = random_directions(2000);
  return waviness(*field_of(ball(radius), kernels), std::vector<Vec3>(rays.size(), Vec3::Zero()), rays,
                  radius - 0.1);
}

// The ball of scenes/staircase.toml: 9,808 particles of a lattice.
TEST(AnisotropicKernels, MakeABallFiveTimesSmootherAndKeepItsVolume) {
  constexpr double kRadius = 0.53 / 0.04;
  const Waviness round = of_ball(Kernels::round, kRadius), smooth = of_ball(Kernels::anisotropic, kRadius);
  EXPECT_LT(5 * smooth.height, round.height);
  EXPECT_LT(5 * smooth.normals, round.normals);
  EXPECT_NEAR(4 * std::numbers::pi / 3 * smooth.mean_cube / static_cast<double>(ball(kRadius).size()), 1,
              0.01);
}

TEST(AnisotropicKernels, MakeAFlatSurfaceSmootherWhereItWas) {
  const std::vector<Vec3> slab = shaken(box(Vec3(17, 17, 3)), 0.2);
  std::mt19937 random(5);
  std::vector<Vec3> origins;
  for (int i = 0; i < 1000; ++i) {
    origins.push_back(testing::random_vector(random, 6));
    origins.back()[2] = 0;
  }
  const std::vector<Vec3> up(origins.size(), Vec3::UnitZ());
  const Waviness round = waviness(*field_of(slab, Kernels::round), origins, up, 3.5),
                 smooth = waviness(*field_of(slab, Kernels::anisotropic), origins, up, 3.5);
  EXPECT_LT(4 * smooth.height, round.height);
  EXPECT_LT(5 * smooth.normals, round.normals);
  EXPECT_NEAR(smooth.mean, 3.5, 0.03);
}

/// Distance at which f falls through 0 on the way from x.
double edge(const Field& field, const Vec3& x, const Vec3& direction) {
  if (field.value_and_gradient(x).f <= 0) return 0;
  double inside = 0, outside = 6;
  while (outside - inside > 1e-6) {
    const double middle = 0.5 * (inside + outside);
    (field.value_and_gradient(x + middle * direction).f > 0 ? inside : outside) = middle;
  }
  return inside;
}

TEST(AnisotropicKernels, KeepSheetsOfOneToFourParticles) {
  for (int layers = 1; layers <= 4; ++layers) {
    const std::vector<Vec3> sheet = box(Vec3(16, 16, 0.5 * (layers - 1)));
    const auto smooth = field_of(sheet, Kernels::anisotropic);
    for (const Vec3& x : {Vec3(0, 0, 0), Vec3(0.5, 0.3, 0), Vec3(0.5, 0.5, 0)})
      EXPECT_NEAR(2 * edge(*smooth, x, Vec3::UnitZ()), layers, 0.03 * layers) << layers;
  }
  EXPECT_EQ(edge(*field_of(box(Vec3(16, 16, 0)), Kernels::round), Vec3::Zero(), Vec3::UnitZ()), 0)
      << "round kernels lose one of a single layer";
}

/// A field with another support radius, and half the inside as threshold.
std::shared_ptr<const Field> field_of(const std::vector<Vec3>& position, double sigma, WeightRule rule) {
  FieldParticles particles = at_rest(position);
  particles.sigma.assign(position.size(), sigma);
  particles.weight = field_weights(position, sigma, rule);
  const double inside = 64 * std::numbers::pi / 315 * sigma * sigma * sigma;
  return particle_field(particles, Kernels::anisotropic, rule == WeightRule::uniform ? 0.5 * inside : 0.5, 0);
}

/// Mean thickness along z near the middle; 0 anywhere: a hole.
double mean_thickness(const Field& field) {
  double sum = 0;
  int lines = 0;
  for (double x = -4; x <= 4; x += 0.7)
    for (double y = -4; y <= 4; y += 0.7, ++lines) {
      double inside = 0;
      for (double z = -2; z < 2; z += 0.01) inside += 0.01 * (field.value_and_gradient(Vec3(x, y, z)).f > 0);
      if (inside == 0) return 0;
      sum += inside;
    }
  return sum / lines;
}

// The thickness is told by the sum of round kernels: whatever sigma is, and where particles are uneven.
TEST(AnisotropicKernels, KeepTheThicknessOfUnevenSheetsAtEachSigma) {
  for (const double sigma : {2.0, 2.5, 3.0})
    for (const double shake : {0.0, 0.05, 0.2}) {
      const auto sheet = field_of(shaken(box(Vec3(12, 12, 0)), shake), sigma, WeightRule::uniform);
      EXPECT_NEAR(mean_thickness(*sheet), 1, 0.05) << sigma << " " << shake;
    }
}

// Drawn out: the particles are further apart than their sheet is thick. Thinner than 0.33 sigma none becomes.
TEST(AnisotropicKernels, MakeSheetsThinnerThatAreDrawnOut) {
  for (const double area : {1.2, 2.0}) {
    std::vector<Vec3> sheet = box(Vec3(12, 12, 0));
    for (Vec3& x : sheet) x *= std::sqrt(area);
    EXPECT_NEAR(mean_thickness(*field_of(sheet, kSigma, WeightRule::uniform)),
                std::max(1 / area, 0.33 * kSigma), 0.05)
        << area;
  }
}

// A body far away, of most of the particles, tells what the inside's weight is.
TEST(AnisotropicKernels, DoNotMakeSheetsThickThatHaveNormalisedWeights) {
  for (const double shake : {0.0, 0.05, 0.2}) {
    std::vector<Vec3> liquid = shaken(box(Vec3(12, 12, 0)), shake);
    for (const Vec3& x : box(Vec3(6, 6, 6))) liquid.emplace_back(x + Vec3(60, 0, 0));
    EXPECT_NEAR(mean_thickness(*field_of(liquid, kSigma, WeightRule::normalised)), 1, 0.1) << shake;
  }
}

TEST(AnisotropicKernels, KeepThreadsOfOneParticleAndLeaveLoneOnesRound) {
  const auto thread = field_of(box(Vec3(0, 0, 20)), Kernels::anisotropic);
  const double radius = 1 / std::sqrt(std::numbers::pi);  // of as much volume
  for (const double z : {0.0, 0.25, 0.5})
    for (const Vec3& across : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.6, 0.8, 0)})
      EXPECT_NEAR(edge(*thread, Vec3(0, 0, z), across), radius, 0.05 * radius);
  for (const double threshold : {2.0, kThreshold}) {  // also where some three particles have a surface
    const KernelShapes lone = kernel_shapes(at_rest({Vec3(3, 4, 5)}), threshold);
    EXPECT_LT((kSigma * kSigma * full(lone.shape[0]) - Mat3::Identity()).norm(), 1e-12);
    EXPECT_EQ(lone.offset[0], Vec3(0, 0, 0));
    EXPECT_NEAR(lone.weight[0], 1, 1e-12);
  }
}

/// Largest difference of two sets of kernels, in units of sigma.
double difference(const KernelShapes& a, const KernelShapes& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    worst = std::max({worst, (a.offset[i] - b.offset[i]).norm() / kSigma,
                      kSigma * kSigma * (full(a.shape[i]) - full(b.shape[i])).norm(),
                      std::abs(a.weight[i] - b.weight[i])});
  return worst;
}

TEST(AnisotropicKernels, TurnWithTheirParticles) {
  const std::vector<Vec3> body = shaken(ball(5), 0.15);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  const Vec3 shift(3, -1, 2);
  std::vector<Vec3> moved = body;
  for (Vec3& x : moved) x = turn * x + shift;
  KernelShapes expected = kernel_shapes(at_rest(body), kThreshold);
  for (std::size_t i = 0; i < body.size(); ++i) {
    expected.offset[i] = turn * expected.offset[i];
    expected.shape[i] = symmetric(turn * full(expected.shape[i]) * turn.transpose());
  }
  EXPECT_LT(difference(kernel_shapes(at_rest(moved), kThreshold), expected), 1e-8);
}

TEST(AnisotropicKernels, ScaleWithTheUnitOfLength) {
  constexpr double kUnit = 1e-3;
  FieldParticles body = at_rest(shaken(ball(4), 0.15)), small = body;
  for (Vec3& x : small.position) x *= kUnit;
  for (double& sigma : small.sigma) sigma *= kUnit;
  KernelShapes shapes = kernel_shapes(small, kThreshold);
  for (Vec3& offset : shapes.offset) offset /= kUnit;
  for (SymmetricMatrix& shape : shapes.shape)
    for (double& entry : shape) entry *= kUnit * kUnit;
  EXPECT_LT(difference(shapes, kernel_shapes(body, kThreshold)), 1e-8);
}

TEST(AnisotropicKernels, DoNotDependOnTheThreads) {
  const FieldParticles body = at_rest(shaken(ball(8), 0.15));
  std::vector<KernelShapes> shapes;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    shapes.push_back(kernel_shapes(body, kThreshold));
  }
  EXPECT_EQ(shapes[0].shape, shapes[1].shape);
  EXPECT_EQ(shapes[0].weight, shapes[1].weight);
  EXPECT_EQ(shapes[0].weight, shapes[2].weight);
  EXPECT_EQ(shapes[0].offset, shapes[2].offset);
  EXPECT_EQ(shapes[0].shape, shapes[2].shape);
}

TEST(AnisotropicKernels, OfABodyDoNotKnowAParticleFarAway) {
  const std::vector<Vec3> body = shaken(ball(4), 0.15);
  std::vector<Vec3> with = body;
  with.emplace_back(1e9, 0, 0);
  const KernelShapes alone = kernel_shapes(at_rest(body), kThreshold),
                     shapes = kernel_shapes(at_rest(with), kThreshold);
  ASSERT_EQ(shapes.size(), body.size() + 1);
  EXPECT_LT(difference(alone, shapes), 1e-9);
  EXPECT_EQ(shapes.weight.back(), 1);
}

// Each particle's windows are as large as its own sigma asks for.
TEST(AnisotropicKernels, OfABodyDoNotKnowAnotherSigmaFarAway) {
  const std::vector<Vec3> body = shaken(ball(4), 0.15);
  const KernelShapes alone = kernel_shapes(at_rest(body), kThreshold);
  for (const double sigma : {0.1, 12.0}) {
    FieldParticles with = at_rest(body);
    for (const double x : {60.0, 60.0 + 0.4 * sigma, 60.0 + 0.8 * sigma}) {
      with.position.emplace_back(x, 0, 0);
      with.velocity.emplace_back(Vec3::Zero());
      with.sigma.push_back(sigma);
      with.weight.push_back(1);
      with.weight_rate.push_back(0);
    }
    EXPECT_LT(difference(alone, kernel_shapes(with, kThreshold)), 1e-9) << sigma;
  }
}

TEST(AnisotropicKernels, RefuseWhatMakesNoField) {
  const FieldParticles body = at_rest(ball(2));
  for (const double threshold : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(kernel_shapes(body, threshold), InvalidInput) << threshold;
  for (const double sigma : {0.0, -1.0, std::nan("")}) {
    FieldParticles bad = body;
    bad.sigma[3] = sigma;
    EXPECT_THROW(kernel_shapes(bad, kThreshold), InvalidInput) << sigma;
  }
  FieldParticles few = body;
  few.weight.pop_back();
  EXPECT_THROW(kernel_shapes(few, kThreshold), InvalidInput);
  EXPECT_EQ(kernel_shapes({}, kThreshold).size(), 0u);
}

/// Rigid motions carry the field exactly: the normal velocity of Eq. 4 is that of the body.
TEST(AnisotropicKernels, MoveRigidlyWithABody) {
  const Vec3 omega(0.3, -0.5, 0.8), u(0.4, 0.1, -0.2);
  const auto velocity = [&](const Vec3& x) { return Vec3(u + omega.cross(x)); };
  Particles body;
  for (const Vec3& x : shaken(ball(6), 0.15)) {
    body.id.push_back(static_cast<std::int64_t>(body.size()));
    body.position.push_back(x);
    body.velocity.push_back(velocity(x));
  }
  constexpr double kStep = 0.02;
  Particles after = body;
  after.time = kStep;
  const Mat3 turn = Eigen::AngleAxisd(kStep * omega.norm(), omega.normalized()).toRotationMatrix();
  // x -> c + R (x - c) + drift dt with c on the axis, where u + omega x c = drift.
  const Vec3 c = omega.cross(u) / omega.squaredNorm(), drift = u.dot(omega) / omega.squaredNorm() * omega;
  ASSERT_LT((u + omega.cross(c) - drift).norm(), 1e-12);
  for (std::size_t i = 0; i < body.size(); ++i) {
    after.position[i] = c + turn * (body.position[i] - c) + kStep * drift;
    after.velocity[i] = velocity(after.position[i]);
  }
  const ParticleFieldOptions options{
      .sigma = kSigma, .threshold = kThreshold, .kernels = Kernels::anisotropic};
  ParticleMotion motion(body, after, options);
  const double fastest = motion.at(0)->fastest_speed();
  for (const auto& field : {particle_field(body, options), motion.at(0.5 * kStep)}) {
    double worst = 0;
    for (const Vec3& d : random_directions(300)) {
      const Vec3 x = 6 * d;
      const Jet jet = field->jet(x);
      worst = std::max(worst, std::abs(jet.f_t + jet.g.dot(velocity(x))) / jet.g.norm());
    }
    EXPECT_LT(worst, 1e-3 * fastest);
  }
}

}  // namespace
}  // namespace kappaflow
