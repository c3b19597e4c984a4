#include "tools/experiments/flow_map_field.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/LU>
#include <random>

#include "surface/field/curvature.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tools/experiments/enright_flow.h"

namespace kappaflow {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPeriod = EnrightFlow::kPeriod;

std::vector<Vec3> points_in_cube(std::size_t count, double margin = 0) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(margin, 1 - margin);
  std::vector<Vec3> points(count);
  for (Vec3& x : points) x = {along(random), along(random), along(random)};
  return points;
}

/// Points of the sphere of Enright's test, carried to time t.
std::vector<Vec3> points_on_surface(std::size_t count, double t) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points(count);
  for (Vec3& x : points)
    x = Vec3::Constant(0.35) + 0.15 * Vec3(normal(random), normal(random), normal(random)).normalized();
  carry<EnrightFlow>(points, 0, t);
  return points;
}

/// Enright's velocity as it is printed, time and all.
Vec3 printed_velocity(const Vec3& x, double t) {
  const auto s = [](double a) { return std::sin(kPi * a); };
  const auto d = [](double a) { return std::sin(2 * kPi * a); };
  return std::cos(kPi * t / 3) * Vec3(2 * s(x[0]) * s(x[0]) * d(x[1]) * d(x[2]),
                                      -d(x[0]) * s(x[1]) * s(x[1]) * d(x[2]),
                                      -d(x[0]) * d(x[1]) * s(x[2]) * s(x[2]));
}

/// The classical method of order 4 in time itself.
Vec3 carried_by_rk4(Vec3 x, double t0, double t1, int steps) {
  const double h = (t1 - t0) / steps;
  for (int n = 0; n < steps; ++n) {
    const double t = t0 + n * h;
    const Vec3 k1 = printed_velocity(x, t), k2 = printed_velocity(x + h / 2 * k1, t + h / 2),
               k3 = printed_velocity(x + h / 2 * k2, t + h / 2), k4 = printed_velocity(x + h * k3, t + h);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return x;
}

Point<double> moved(Point<double> x, double s, int steps) {
  for (int n = 0; n < steps; ++n) flow_step<EnrightFlow>(s / steps, x);
  return x;
}

Vec3 vector(const Point<double>& x) {
  return {x[0], x[1], x[2]};
}

TEST(FlowMap, ErrorFallsWithTheOrderOfTheMethod) {
  std::vector<double> error;
  for (const int steps : {16, 32}) {
    double sum = 0;
    for (const Vec3& x : points_in_cube(200)) {
      const Point<double> start{x[0], x[1], x[2]};
      sum += (vector(moved(start, 0.9, steps)) - vector(moved(start, 0.9, 128))).squaredNorm();
    }
    error.push_back(std::sqrt(sum));
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), FlowMapMethod::kOrder, 0.5);
}

TEST(FlowMap, FollowsTheTimeDependentFlowToItsTolerance) {
  for (const auto& [t0, t1] : {std::pair{0.0, 1.5}, {0.2, 2.1}, {1.5, 3.0}, {1.2, 0.1}}) {
    std::vector<Vec3> points = points_in_cube(20);
    const std::vector<Vec3> start = points;
    carry<EnrightFlow>(points, t0, t1);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LT((points[i] - carried_by_rk4(start[i], t0, t1, 2000)).norm(), 1e-9);
  }
}

TEST(FlowMap, CarriedThereAndBackIsWhereItWas) {
  std::vector<Vec3> points = points_in_cube(100);
  const std::vector<Vec3> start = points;
  carry<EnrightFlow>(points, 0.1, 1.4);
  EXPECT_GT((points[0] - start[0]).norm(), 1e-3);
  carry<EnrightFlow>(points, 1.4, 0.1);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LT((points[i] - start[i]).norm(), 2e-9);
}

TEST(FlowMap, SameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<Vec3>> result(2, points_in_cube(2000));
  for (const std::size_t i : {0, 1}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1 + 2 * i);
    carry<EnrightFlow>(result[i], 0, 0.5);
  }
  EXPECT_EQ(result[0], result[1]);
}

TEST(FlowMap, KeepsVolumes) {
  for (const Vec3& x : points_in_cube(100)) {
    const Point<Taylor<1>> X = flow_map<EnrightFlow>(
        -EnrightFlow::path(1.5), Point<Taylor<1>>{Taylor<1>::variable(x[0], 0), Taylor<1>::variable(x[1], 1),
                                                  Taylor<1>::variable(x[2], 2)});
    Mat3 D;
    D << X[0].gradient(), X[1].gradient(), X[2].gradient();
    EXPECT_NEAR(D.determinant(), 1, 1e-8 * D.squaredNorm());
  }
}

TEST(EnrightFlow, LargestSpeedIsNeverExceededAndIsMet) {
  for (const Vec3& x : points_in_cube(20000))
    EXPECT_LE(flow_velocity<EnrightFlow>(x, 0).norm(), EnrightFlow::kLargestSpeed);
  EXPECT_NEAR(flow_velocity<EnrightFlow>(Vec3(0.5, 0.25, 0.25), 0).norm(), EnrightFlow::kLargestSpeed, 1e-15);
  for (const double t : {0.0, 0.4, 2.9}) {
    const EnrightField field(t);
    for (const Vec3& x : points_in_cube(50)) {
      const Vec3 u = field.material_velocity(x).value();
      EXPECT_LT((u - printed_velocity(x, t)).norm(), 1e-14);
      EXPECT_LE(u.norm(), field.fastest_speed());
      EXPECT_NEAR(field.jet(x).fastest_in_reach, u.norm(), 1e-14);
    }
  }
}

TEST(EnrightField, IsTheSphereAtFirst) {
  const EnrightField field(0);
  for (const Vec3& x : points_on_surface(50, 0)) {
    const Jet jet = field.jet(x);
    EXPECT_NEAR(jet.f, 0, 1e-15);
    EXPECT_LT((jet.g - (Vec3::Constant(0.35) - x) / 0.15).norm(), 1e-13);
    const CurvatureJet curvature = curvature_jet(jet);
    EXPECT_NEAR(curvature.H, 1 / 0.15, 1e-11);
    EXPECT_NEAR(curvature.K, 1 / (0.15 * 0.15), 1e-10);
  }
}

TEST(EnrightField, IsCarriedByTheFlow) {
  const std::vector<Vec3> start = points_in_cube(200);
  for (const double t : {0.3, 1.5, 2.4, 3.0}) {
    std::vector<Vec3> points = start;
    carry<EnrightFlow>(points, 0, t);
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_NEAR(EnrightField(t).value_and_gradient(points[i]).f,
                  EnrightField(0).value_and_gradient(start[i]).f, 1e-8);
  }
}

TEST(EnrightField, RunsBackwardAfterHalfTime) {
  for (const double t : {0.0, 0.4, 1.1})
    for (const Vec3& x : points_in_cube(20)) {
      const Jet forth = EnrightField(t).jet(x), back = EnrightField(kPeriod - t).jet(x);
      const double size = 1 + forth.A.norm();
      EXPECT_NEAR(forth.f, back.f, 1e-13 * size);
      EXPECT_LT((forth.A - back.A).norm(), 1e-11 * size);
      EXPECT_NEAR(forth.f_t, -back.f_t, 1e-12 * size);
    }
  for (const Vec3& x : points_in_cube(20)) EXPECT_NEAR(EnrightField(kPeriod / 2).jet(x).f_t, 0, 1e-12);
}

TEST(EnrightField, IsNegativeOutsideOfItsBounds) {
  for (const double t : {0.0, 0.7, 1.5})
    for (Vec3 x : points_in_cube(60)) {
      x[0] = x[0] < 0.5 ? 0 : 1;
      EXPECT_LT(EnrightField(t).value_and_gradient(x).f, 0);
    }
  EXPECT_EQ(EnrightField(1).bounds().upper, Vec3(1, 1, 1));
}

/// (f(-2h) - 8 f(-h) + 8 f(h) - f(2h)) / 12h, of order 4.
template <class Function>
auto difference(const Function& f, double h) {
  using Value = std::decay_t<decltype(f(h))>;
  return Value((f(-2 * h) - 8 * f(-h) + 8 * f(h) - f(2 * h)) / (12 * h));
}

// Each derivative against differences of the one below it.
TEST(EnrightField, DerivativesAreThoseOfTheField) {
  constexpr double h = 2e-4;
  for (const double t : {0.4, 1.5, 2.2}) {
    const EnrightField field(t);
    for (const Vec3& x : points_on_surface(12, t)) {
      const Jet jet = field.jet(x);
      const double size = 1 + jet.A.norm() + jet.C.contract(Vec3::Ones()).norm();
      EXPECT_LT((field.value_and_gradient(x).g - jet.g).norm(), 1e-12 * size);
      for (int a = 0; a < 3; ++a) {
        const auto along = [&](double d) { return field.jet(x + d * Vec3::Unit(a)); };
        const auto f = [&](double d) { return along(d).f; };
        const auto g = [&](double d) { return along(d).g; };
        const auto A = [&](double d) { return along(d).A; };
        EXPECT_NEAR(difference(f, h), jet.g[a], 1e-6 * size);
        EXPECT_LT((difference(g, h) - jet.A.col(a)).norm(), 1e-5 * size);
        EXPECT_LT((difference(A, h) - jet.C.contract(Vec3::Unit(a))).norm(), 1e-4 * size);
      }
    }
  }
}

// The number of steps of the flow map does not change within these differences in time.
TEST(EnrightField, RatesAreThoseOfTheFieldInTime) {
  constexpr double h = 2e-4;
  for (const double t : {0.4, 1.2, 2.2})
    for (const Vec3& x : points_on_surface(12, t)) {
      const Jet jet = EnrightField(t).jet(x);
      const double size = 1 + std::abs(jet.f_t) + jet.g_t.norm() + jet.A_t.norm();
      const auto f = [&](double d) { return EnrightField(t + d).jet(x).f; };
      const auto g = [&](double d) { return EnrightField(t + d).jet(x).g; };
      const auto A = [&](double d) { return EnrightField(t + d).jet(x).A; };
      EXPECT_NEAR(difference(f, h), jet.f_t, 1e-7 * size);
      EXPECT_LT((difference(g, h) - jet.g_t).norm(), 1e-6 * size);
      EXPECT_LT((difference(A, h) - jet.A_t).norm(), 1e-5 * size);
    }
}

// Df/Dt = 0 and its derivatives: g_t = -A u - (grad u)^T g, with differences of the velocity alone.
TEST(EnrightField, TransportIdentitiesHold) {
  for (const double t : {0.4, 1.2, 2.2})
    for (const Vec3& x : points_on_surface(12, t)) {
      const Jet jet = EnrightField(t).jet(x);
      const Vec3 u = flow_velocity<EnrightFlow>(x, t);
      Mat3 grad_u;  // column a: du/dx_a
      for (int a = 0; a < 3; ++a)
        grad_u.col(a) =
            difference([&](double d) { return flow_velocity<EnrightFlow>(x + d * Vec3::Unit(a), t); }, 1e-3);
      EXPECT_NEAR(jet.f_t, -u.dot(jet.g), 1e-12);
      EXPECT_LT((jet.g_t + jet.A * u + grad_u.transpose() * jet.g).norm(), 1e-7 * (1 + jet.g.norm()));
    }
}

TEST(EnrightField, CurvaturesChangeAsTheirRatesSay) {
  constexpr double h = 1e-4;
  for (const Vec3& x : points_on_surface(12, 0.5)) {
    const CurvatureJet at = curvature_jet(EnrightField(0.5).jet(x));
    const auto in_time = [&](double d) { return curvature_jet(EnrightField(0.5 + d).jet(x)); };
    EXPECT_NEAR(difference([&](double d) { return in_time(d).K; }, h), at.K_t, 1e-5 * (1 + std::abs(at.K_t)));
    EXPECT_NEAR(difference([&](double d) { return in_time(d).H; }, h), at.H_t, 1e-5 * (1 + std::abs(at.H_t)));
    for (int a = 0; a < 3; ++a) {
      const auto along = [&](double d) {
        return curvature_jet(EnrightField(0.5).jet(x + d * Vec3::Unit(a)));
      };
      EXPECT_NEAR(difference([&](double d) { return along(d).K; }, h), at.grad_K[a],
                  1e-5 * (1 + at.grad_K.norm()));
      EXPECT_NEAR(difference([&](double d) { return along(d).H; }, h), at.grad_H[a],
                  1e-5 * (1 + at.grad_H.norm()));
    }
  }
}

/// An ellipsoid that turns about an axis through its centre, with a speed that varies in time: known exactly.
struct TurningEllipsoid {
  static constexpr double kLongestStep = 0.2, kLargestSpeed = 10, kLengthScale = 0.5;
  static constexpr std::array<double, 3> kSpin{0.6, 1.1, -0.7}, kSemiAxes{1, 0.7, 0.5};
  template <class Number>
  static Point<Number> velocity(const Point<Number>& x) {
    return {kSpin[1] * x[2] - kSpin[2] * x[1], kSpin[2] * x[0] - kSpin[0] * x[2],
            kSpin[0] * x[1] - kSpin[1] * x[0]};
  }
  template <class Number>
  static Number initial_value(const Point<Number>& x) {
    const auto square = [&](int a) { return 1 / (kSemiAxes[a] * kSemiAxes[a]) * (x[a] * x[a]); };
    return 1.0 - (square(0) + square(1) + square(2));
  }
  static double rate(double t) { return 1 + t; }
  static double path(double t) { return t + t * t / 2; }
  static Bounds bounds() { return {Vec3(-1, -1, -1), Vec3(1, 1, 1)}; }
};

TEST(FlowMapField, OfARotationIsTheTurnedBody) {
  constexpr double t = 0.8;
  const Vec3 spin(0.6, 1.1, -0.7), axes(1, 0.7, 0.5);
  const testing::EllipsoidField expected(Vec3::Zero(), testing::rotation(TurningEllipsoid::path(t) * spin),
                                         axes, Vec3::Zero(), TurningEllipsoid::rate(t) * spin);
  const FlowMapField<TurningEllipsoid> field(t);
  for (const Vec3& x : points_in_cube(50)) {
    const Jet a = field.jet(x), b = expected.jet(x);
    EXPECT_NEAR(a.f, b.f, 1e-8);
    EXPECT_LT((a.g - b.g).norm(), 1e-8);
    EXPECT_LT((a.A - b.A).norm(), 1e-8);
    EXPECT_LT(a.C.contract(Vec3::Ones()).norm(), 1e-12);
    EXPECT_NEAR(a.f_t, b.f_t, 1e-7);
    EXPECT_LT((a.g_t - b.g_t).norm(), 1e-7);
    EXPECT_LT((a.A_t - b.A_t).norm(), 1e-7);
    EXPECT_LT((*field.material_velocity(x) - *expected.material_velocity(x)).norm(), 1e-14);
  }
}

TEST(FlowMapMotion, RefusesTimesOutsideOfTheStep) {
  EXPECT_THROW(EnrightMotion(1, 1), InvalidInput);
  EnrightMotion motion(1, 2);
  EXPECT_EQ(motion.at(1.25)->time(), 1.25);
  EXPECT_THROW(motion.at(2.5), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
