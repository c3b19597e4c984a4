#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <numbers>
#include <set>

#include "core/errors.h"
#include "surface/field/curvature.h"
#include "surface/field/particle_motion.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"
#include "surface/motion/velocity_methods.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/motion/surface_points.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::random_vector;
using testing::surface_points;
using testing::velocities_at;

/// Nearly no damping and no limit: what the equations themselves say.
constexpr VelocityOptions kUndamped{.damping = 1e-9, .speed_limit = 1e6};

/// A body of seven unequal particles with random velocities, in a world of another size.
ParticleField tumbling_body(double scale = 1) {
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(1);
  testing::set_velocities(body.particles,
                          [&](const Vec3&) { return Vec3(scale * random_vector(random, 1)); });
  for (Vec3& x : body.particles.position) x *= scale;
  for (double& sigma : body.particles.sigma) sigma *= scale;
  return ParticleField(body.particles, body.threshold, 0);
}

TEST(VelocityMethods, AreFoundByName) {
  std::set<std::string_view> names;
  for (const VelocityMethod& method : velocity_methods()) {
    EXPECT_EQ(&velocity_method(method.name), &method);
    names.insert(method.name);
  }
  for (const std::string_view known :
       {"normal", "total", "curvature", "curvature-only", "curvature-first", "regional", "material"})
    EXPECT_TRUE(names.contains(known)) << known;
  try {
    velocity_method("magic");
    FAIL() << "an unknown method was accepted";
  } catch (const InvalidInput& error) {
    for (const std::string_view name : names)
      EXPECT_NE(std::string_view(error.what()).find(name), std::string::npos);
  }
}

TEST(VelocityMethods, ShareTheNormalPartOfEquation4) {
  const ParticleField field = tumbling_body();
  const std::vector<Vec3> points = surface_points(field, 200, 2);
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities result = velocities_at(field, method.name, points, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Jet jet = field.jet(points[i]);
      EXPECT_NEAR(result.velocity[i].dot(jet.g) + jet.f_t, 0, 1e-12) << method.name;
    }
  }
}

// A field that is smooth where its pattern is not: each method reads the motion along the surface from the
// pattern, and that across it from the field itself.
TEST(VelocityMethods, FollowThePatternAlongTheSurfaceOfTheField) {
  testing::Body body = testing::read_body175();
  std::mt19937 random(3);
  testing::set_velocities(body.particles, [&](const Vec3&) { return random_vector(random, 1); });
  const auto field = particle_field(body.particles, Kernels::anisotropic, body.threshold, 0);
  const std::vector<Vec3> points = surface_points(*field, 200, 5);
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities result = velocities_at(*field, method.name, points, {}),
                            of_pattern = velocities_at(field->pattern(), method.name, points, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Jet jet = field->jet(points[i]);
      const Vec3 n = jet.g.normalized(), v_n = normal_velocity(jet, {});
      EXPECT_NEAR((result.velocity[i] - v_n).dot(n), 0, 1e-12) << method.name;
      if (method.name == "normal") {
        EXPECT_LT((result.velocity[i] - v_n).norm(), 1e-12) << "it has nothing along the surface";
        continue;
      }
      // Regional takes its windows' motion along the field's own surface, material that of the particles.
      if (method.name == "regional" || method.name == "material") continue;
      const Vec3 undetermined =
          (1 - of_pattern.confidence[i]) * normal_velocity(field->pattern().jet(points[i]), {});
      const Vec3 difference = result.velocity[i] - (of_pattern.velocity[i] - undetermined);
      EXPECT_LT((difference - difference.dot(n) * n).norm(), 1e-12) << method.name;
      EXPECT_EQ(result.confidence[i], of_pattern.confidence[i]) << method.name;
    }
  }
}

TEST(NormalVelocity, IsLimitedByTheFastestInReach) {
  Jet jet;
  jet.g = Vec3(0, 0, 1e-3);
  jet.f_t = 1;
  jet.length_scale = 1;
  jet.fastest_in_reach = 2;
  EXPECT_LT((normal_velocity(jet, {.speed_limit = 1}) - Vec3(0, 0, -2)).norm(), 1e-14);
  EXPECT_LT((normal_velocity(jet, {.speed_limit = 4}) - Vec3(0, 0, -8)).norm(), 1e-14);
  jet.f_t = 1e-3;
  EXPECT_LT((normal_velocity(jet, {.speed_limit = 1}) - Vec3(0, 0, -1)).norm(), 1e-14);
}

// What flies far away says nothing about how fast the surface here may be.
TEST(VelocityMethods, AreLimitedByTheFastestInReachAlone) {
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(1);
  testing::set_velocities(body.particles, [&](const Vec3&) { return random_vector(random, 1); });
  const std::vector<Vec3> points = surface_points(ParticleField(body.particles, body.threshold, 0), 200, 14);
  body.particles.position.emplace_back(100, 0, 0);
  body.particles.velocity.emplace_back(1000, 0, 0);
  for (auto* array : {&body.particles.sigma, &body.particles.weight, &body.particles.weight_rate})
    array->push_back(array->front());
  const ParticleField field(body.particles, body.threshold, 0);
  ASSERT_EQ(field.fastest_speed(), 1000);
  for (const char* method : {"total", "curvature", "curvature-only", "curvature-first", "regional"}) {
    const SurfaceVelocities result = velocities_at(field, method, points, {.damping = 1e-9});
    int limited = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Jet jet = field.jet(points[i]);
      const Vec3 n = jet.g.normalized();
      const double along = (result.velocity[i] - result.velocity[i].dot(n) * n).norm();
      EXPECT_LE(along, jet.fastest_in_reach * (1 + 1e-12)) << method;
      limited += along > jet.fastest_in_reach * (1 - 1e-12);
    }
    EXPECT_GT(limited, 5) << method << ": nothing was to be limited";
  }
}

// What a method promises: its own residuals vanish along the motion (Eqs. 5, 7 and 8).
TEST(TotalVelocity, KeepsTheNormal) {
  const ParticleField field = tumbling_body();
  const std::vector<Vec3> points = surface_points(field, 100, 3);
  const SurfaceVelocities result = velocities_at(field, "total", points, kUndamped);
  int determined = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (result.confidence[i] < 1 - 1e-12) continue;
    ++determined;
    const Jet jet = field.jet(points[i]);
    const Vec3 g_rate = jet.A * result.velocity[i] + jet.g_t, n = jet.g.normalized();
    const double size = 1 + result.velocity[i].norm() * jet.A.norm();
    EXPECT_LT((g_rate - g_rate.dot(n) * n).norm(), 1e-9 * size);
  }
  EXPECT_GT(determined, 90);
}

TEST(CurvatureOnlyVelocity, KeepsBothCurvatures) {
  const ParticleField field = tumbling_body();
  const std::vector<Vec3> points = surface_points(field, 100, 4);
  const SurfaceVelocities result = velocities_at(field, "curvature-only", points, kUndamped);
  int determined = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (result.confidence[i] < 1 - 1e-12) continue;
    ++determined;
    const CurvatureJet c = curvature_jet(field.jet(points[i]));
    const double speed = 1 + result.velocity[i].norm();
    EXPECT_NEAR(c.grad_K.dot(result.velocity[i]) + c.K_t, 0, 1e-8 * speed * (1 + c.grad_K.norm()));
    EXPECT_NEAR(c.grad_H.dot(result.velocity[i]) + c.H_t, 0, 1e-8 * speed * (1 + c.grad_H.norm()));
  }
  EXPECT_GT(determined, 50);  // the rest are caps that one particle alone makes
}

// Eq. 10 by brute force: no tangential velocity on a fine grid of directions and lengths has smaller
// residuals, in units of the length scale or as they are.
void expect_least_sum_of_equation_10(const ParticleField& field, RowScale row_scale) {
  VelocityOptions options = kUndamped;
  options.row_scale = row_scale;
  const std::vector<Vec3> points = surface_points(field, 30, 5);
  const SurfaceVelocities result = velocities_at(field, "curvature", points, options);
  const auto sum_of_squares = [&](const Jet& jet, const Vec3& v) {
    const CurvatureJet c = curvature_jet(jet);
    const double L = row_scale == RowScale::metre ? 1 : jet.length_scale;
    const Vec3 n = jet.g.normalized(), g_rate = jet.A * v + jet.g_t;
    return (L / jet.g.norm() * (g_rate - g_rate.dot(n) * n)).squaredNorm() +
           std::pow(L * L * L * (c.grad_K.dot(v) + c.K_t), 2) +
           std::pow(L * L * (c.grad_H.dot(v) + c.H_t), 2);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Jet jet = field.jet(points[i]);
    const TangentBasis E = tangent_basis(jet.g.normalized());
    const double least = sum_of_squares(jet, result.velocity[i]);
    for (int k = 0; k < 32; ++k)
      for (double length = 1e-4; length < 10; length *= 3) {
        const double angle = 2 * std::numbers::pi * k / 32;
        const Vec2 y = jet.length_scale * length * Vec2(std::cos(angle), std::sin(angle));
        const Vec3 v = result.velocity[i] + E * y;
        EXPECT_GE(sum_of_squares(jet, v), least * (1 - 1e-9));
      }
  }
}

TEST(CurvatureVelocity, MinimisesTheSumOfEquation10) {
  expect_least_sum_of_equation_10(tumbling_body(), RowScale::sigma);
  expect_least_sum_of_equation_10(tumbling_body(0.05), RowScale::sigma);
  expect_least_sum_of_equation_10(tumbling_body(0.05), RowScale::metre);
}

/// Three equal particles that turn, of that sigma [m].
ParticleField three_particles(double sigma) {
  FieldParticles particles;
  const Vec3 turn(0.3, -0.2, 1);
  for (const Vec3& x : {Vec3(0.4, 0, 0), Vec3(-0.2, 0.35, 0), Vec3(-0.1, -0.3, 0.1)}) {
    particles.position.push_back(sigma * x);
    particles.velocity.push_back(sigma * turn.cross(x));
    particles.sigma.push_back(sigma);
    particles.weight.push_back(1);
    particles.weight_rate.push_back(0);
  }
  return ParticleField(particles, 0.3, 0);
}

TEST(RowScale, ChangesNothingWhereSigmaIsAMetre) {
  const ParticleField field = three_particles(1);
  const std::vector<Vec3> points = surface_points(field, 100, 9);
  for (const char* method : {"total", "curvature", "curvature-only", "curvature-first"}) {
    const SurfaceVelocities scaled = velocities_at(field, method, points, {.speed_limit = 4}),
                            plain = velocities_at(field, method, points,
                                                  {.speed_limit = 4, .row_scale = RowScale::metre});
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((scaled.velocity[i] - plain.velocity[i]).norm(), 1e-12) << method;
      EXPECT_NEAR(scaled.confidence[i], plain.confidence[i], 1e-12);
    }
  }
}

// The plain sum of a world of that sigma is the scaled one with the weights 1/sigma, 1/sigma^3 and 1/sigma^2.
TEST(RowScale, PlainSumsWeighTheRowsByTheirUnits) {
  for (const double sigma : {10.0, 0.1, 0.01}) {
    const ParticleField field = three_particles(sigma);
    const std::vector<Vec3> points = surface_points(field, 100, 9);
    VelocityOptions plain = kUndamped;
    plain.row_scale = RowScale::metre;
    const SurfaceVelocities result = velocities_at(field, "curvature", points, plain);
    double change = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Jet jet = field.jet(points[i]);
      const TangentBasis E = tangent_basis(jet.g.normalized());
      const Vec3 v_n = normal_velocity(jet, plain);
      const TangentialRows<4> rows =
          stacked(total_rows(jet, E, v_n, sigma), curvature_rows(jet, E, v_n, sigma));
      const Eigen::Vector4d weight(1 / sigma, 1 / sigma, std::pow(sigma, -3), std::pow(sigma, -2));
      const Eigen::Matrix<double, 4, 2> R = weight.asDiagonal() * rows.R;
      const Eigen::Vector4d b = weight.cwiseProduct(rows.b);
      const Vec2 scaled = rows.R.colPivHouseholderQr().solve(rows.b),
                 weighted = R.colPivHouseholderQr().solve(b);
      EXPECT_LT((result.velocity[i] - v_n - E * weighted).norm(), 1e-6 * (sigma + weighted.norm())) << sigma;
      change = std::max(change, (scaled - weighted).norm() / sigma);
    }
    EXPECT_GT(change, 0.1) << "the unit of length matters";
  }
}

TEST(VelocityMethods, DoNotDependOnTheTangentBasis) {
  const ParticleField field = tumbling_body();
  for (const Vec3& x : surface_points(field, 50, 6)) {
    const Jet jet = field.jet(x);
    const Vec3 v_n = normal_velocity(jet, {});
    const TangentBasis E = tangent_basis(jet.g.normalized());
    const TangentBasis turned = E * Eigen::Rotation2Dd(0.7).toRotationMatrix();
    const double L = jet.length_scale;
    const auto velocity = [&](const TangentBasis& basis) -> Vec3 {
      return basis *
             solve_damped(stacked(total_rows(jet, basis, v_n, L), curvature_rows(jet, basis, v_n, L)), 0.1).y;
    };
    EXPECT_LT((velocity(E) - velocity(turned)).norm(), 1e-12);
  }
}

/// What rounding may change: a point alone leaves much of the affine motion of `regional` to its small
/// damping, which rounding is divided by.
double rounding(const VelocityMethod& method) {
  return method.name == "regional" ? 1e-7 : 1e-10;
}

TEST(VelocityMethods, TurnWithTheFrame) {
  const Mat3 Q = Eigen::AngleAxisd(1.1, Vec3(1, 2, -2).normalized()).toRotationMatrix();
  const Vec3 shift(3, -1, 2);
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(7);
  testing::set_velocities(body.particles, [&](const Vec3&) { return random_vector(random, 1); });
  const ParticleField field(body.particles, body.threshold, 0);
  for (Vec3& x : body.particles.position) x = Q * x + shift;
  for (Vec3& v : body.particles.velocity) v = Q * v;
  const ParticleField turned(body.particles, body.threshold, 0);

  const std::vector<Vec3> points = surface_points(field, 100, 8);
  std::vector<Vec3> turned_points;
  for (const Vec3& x : points) turned_points.push_back(Q * x + shift);
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities a = velocities_at(field, method.name, points, {});
    const SurfaceVelocities b = velocities_at(turned, method.name, turned_points, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((Q * a.velocity[i] - b.velocity[i]).norm(), rounding(method)) << method.name;
      EXPECT_NEAR(a.confidence[i], b.confidence[i], 1e-10) << method.name;
    }
  }
}

// Scaling lengths and times scales velocities: the damped solutions have no hidden units.
TEST(VelocityMethods, ScaleWithTheUnits) {
  constexpr double kLength = 0.01, kTime = 5;
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(9);
  testing::set_velocities(body.particles, [&](const Vec3&) { return random_vector(random, 1); });
  const ParticleField field(body.particles, body.threshold, 0);
  for (Vec3& x : body.particles.position) x *= kLength;
  for (Vec3& v : body.particles.velocity) v *= kLength / kTime;
  for (double& sigma : body.particles.sigma) sigma *= kLength;
  const ParticleField scaled(body.particles, body.threshold, 0);
  const std::vector<Vec3> points = surface_points(field, 100, 10);
  std::vector<Vec3> scaled_points;
  for (const Vec3& x : points) scaled_points.push_back(kLength * x);
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities a = velocities_at(field, method.name, points, {});
    const SurfaceVelocities b = velocities_at(scaled, method.name, scaled_points, {});
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((a.velocity[i] - kTime / kLength * b.velocity[i]).norm(), rounding(method)) << method.name;
  }
}

// On a sphere K and H are constant: curvature adds nothing to total, and knows nothing by itself.
TEST(VelocityMethods, OnOneParticleCurvatureIsTotal) {
  const FieldParticles one{.position = {Vec3(0.1, 0.2, 0.3)},
                           .velocity = {Vec3(1, -2, 0.5)},
                           .sigma = {1},
                           .weight = {1},
                           .weight_rate = {0}};
  const ParticleField sphere(one, 0.3, 0);
  const std::vector<Vec3> points = surface_points(sphere, 100, 11);
  for (const VelocityOptions& options : {VelocityOptions{}, kUndamped}) {
    const SurfaceVelocities total = velocities_at(sphere, "total", points, options);
    const SurfaceVelocities curvature = velocities_at(sphere, "curvature", points, options);
    const SurfaceVelocities alone = velocities_at(sphere, "curvature-only", points, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((total.velocity[i] - curvature.velocity[i]).norm(), 1e-12);
      EXPECT_LT(alone.confidence[i], 1e-12);
    }
  }
  const SurfaceVelocities total = velocities_at(sphere, "total", points, kUndamped);
  for (const Vec3& v : total.velocity) EXPECT_LT((v - Vec3(1, -2, 0.5)).norm(), 1e-12);
}

TEST(VelocityMethods, OnAMovingEllipsoid) {
  const Mat3 turned = Eigen::AngleAxisd(0.4, Vec3(1, 1, 0).normalized()).toRotationMatrix();
  const Vec3 centre(0.3, 0, -0.2), velocity(1, 2, -1), angular_velocity(0.5, -1, 2);
  const EllipsoidField translating(centre, turned, Vec3(1, 1.4, 2), velocity);
  const std::vector<Vec3> points = surface_points(translating, 100, 12);
  for (const auto* method : {"total", "curvature-only", "curvature", "material"}) {
    const SurfaceVelocities result = velocities_at(translating, method, points, kUndamped);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((result.velocity[i] - velocity).norm(), 1e-5)
          << method;  // curvature rows get small near planes of symmetry
  }
  const EllipsoidField turning(centre, turned, Vec3(1, 1.4, 2), velocity, angular_velocity);
  for (const auto* method : {"curvature-only", "material"}) {
    const SurfaceVelocities result = velocities_at(turning, method, points, kUndamped);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((result.velocity[i] - velocity - angular_velocity.cross(points[i] - centre)).norm(), 1e-5)
          << method;
  }
}

/// Two particles of sigma 1 whose surfaces join in a neck, the one turning about the other.
ParticleField dumbbell() {
  const FieldParticles two{.position = {Vec3(-0.55, 0, 0), Vec3(0.55, 0, 0)},
                           .velocity = {Vec3(0, 0, 0), Vec3(0, 1, 0.5)},
                           .sigma = {1, 1},
                           .weight = {1, 1},
                           .weight_rate = {0, 0}};
  return ParticleField(two, 0.3, 0);
}

TEST(VelocityMethods, StayBoundedWhereTheNecksGaussianCurvatureVanishes) {
  const ParticleField field = dumbbell();
  // A meridian of the surface from the neck (K < 0) to the side of a blob (K > 0), bisected for K = 0.
  const auto on_surface = [&](double along) {
    Vec3 x(along, 0.4, 0);
    for (int i = 0; i < 50; ++i) {
      const ValueAndGradient at = field.value_and_gradient(x);
      x[1] -= at.f / at.g[1];
    }
    return x;
  };
  double neck = 0, side = 0.5;
  ASSERT_LT(curvature_jet(field.jet(on_surface(neck))).K, 0);
  ASSERT_GT(curvature_jet(field.jet(on_surface(side))).K, 0);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (neck + side);
    (curvature_jet(field.jet(on_surface(middle))).K < 0 ? neck : side) = middle;
  }
  const std::vector<Vec3> parabolic{on_surface(neck), on_surface(side), on_surface(neck + 1e-9)};
  for (const VelocityMethod& method : velocity_methods())
    for (const double damping : {0.1, 1e-6, 0.0}) {
      const SurfaceVelocities result = velocities_at(field, method.name, parabolic, {.damping = damping});
      for (const Vec3& v : result.velocity) EXPECT_LE(v.norm(), 2 * field.fastest_speed()) << method.name;
    }
  for (const double c : velocities_at(field, "total", parabolic, {.damping = 0.1}).confidence)
    EXPECT_LT(c, 1e-6);
}

TEST(VelocityMethods, ConfidenceIsBetweenZeroAndOneAndFallsWithDamping) {
  const ParticleField field = tumbling_body();
  const std::vector<Vec3> points = surface_points(field, 200, 13);
  for (const VelocityMethod& method : velocity_methods()) {
    std::vector<double> previous(points.size(), 1.0);
    for (const double damping : {1e-9, 1e-3, 0.1, 10.0}) {
      const SurfaceVelocities result = velocities_at(field, method.name, points, {.damping = damping});
      for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_GE(result.confidence[i], 0) << method.name;
        EXPECT_LE(result.confidence[i], previous[i]) << method.name;
      }
      previous = result.confidence;
    }
  }
  for (const double c : velocities_at(field, "normal", points, {}).confidence) EXPECT_EQ(c, 0);
  for (const double c : velocities_at(field, "material", points, {}).confidence) EXPECT_EQ(c, 1);
  // Eq. 10 has the rows of total and more.
  const SurfaceVelocities total = velocities_at(field, "total", points, {});
  const SurfaceVelocities both = velocities_at(field, "curvature", points, {});
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_GE(both.confidence[i], total.confidence[i] - 1e-12);
}

TEST(VelocityMethods, AreZeroWhereTheFieldHasNoGradient) {
  const FieldParticles one{.position = {Vec3::Zero()},
                           .velocity = {Vec3(1, 0, 0)},
                           .sigma = {1},
                           .weight = {1},
                           .weight_rate = {0}};
  const ParticleField lone(one, 0.3, 0);
  // Out of reach; at a particle's centre; and next to both, where quotients would overflow.
  const std::vector<Vec3> points{Vec3(10, 0, 0), Vec3::Zero(), Vec3(1e-100, 0, 0), Vec3(1 - 1e-16, 0, 0)};
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities result = velocities_at(lone, method.name, points, {});
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(result.velocity[i], Vec3(0, 0, 0)) << method.name;
      EXPECT_EQ(result.confidence[i], 0) << method.name;
    }
  }
}

TEST(MaterialVelocityMethod, SaysWhenThereIsNone) {
  const testing::TorusField torus(1, 0.3);
  try {
    velocities_at(torus, "material", {Vec3(1.3, 0, 0)}, {});
    FAIL() << "a field without particle velocities was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string_view(error.what()).find("no particle velocities"), std::string_view::npos);
  }
}

TEST(VelocityMethods, AreTheSameForAnyNumberOfThreads) {
  const ParticleField field = tumbling_body();
  const std::vector<Vec3> points = surface_points(field, 1000, 14);
  for (const VelocityMethod& method : velocity_methods()) {
    std::vector<SurfaceVelocities> results;
    for (const std::size_t threads : {1, 2, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(velocities_at(field, method.name, points, {}));
    }
    for (const std::size_t k : {1, 2}) {
      EXPECT_EQ(results[0].velocity, results[k].velocity);
      EXPECT_EQ(results[0].confidence, results[k].confidence);
    }
  }
}

}  // namespace
}  // namespace kappaflow
