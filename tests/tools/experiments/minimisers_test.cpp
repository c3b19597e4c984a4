#include "tools/experiments/minimisers.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "surface/motion/curvature_invariance.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/motion/surface_points.h"
#include "tests/surface/motion/tangential_problems.h"
#include "tests/surface/reference_data.h"
#include "tools/experiments/searched_velocity.h"
#include "tools/experiments/tangential_minimum.h"

namespace kappaflow {
namespace {

/// Minimum (1, 1), value 0, at the end of a curved valley (Rosenbrock 1960).
double rosenbrock(const Vec2& x, Vec2& gradient) {
  const double a = 1 - x[0], b = x[1] - x[0] * x[0];
  gradient = Vec2(-2 * a - 400 * x[0] * b, 200 * b);
  return a * a + 100 * b * b;
}

/// Minimum (3, 0.5), value 0 (Beale 1958).
double beale(const Vec2& x, Vec2& gradient) {
  double value = 0, y_power = 1;
  gradient.setZero();
  for (const double c : {1.5, 2.25, 2.625}) {
    const double slope = (1 + (c > 2) + (c > 2.5)) * y_power;  // n y^(n-1)
    y_power *= x[1];
    const double r = c - x[0] * (1 - y_power);
    value += r * r;
    gradient += 2 * r * Vec2(y_power - 1, x[0] * slope);
  }
  return value;
}

using TestFunction = double (*)(const Vec2&, Vec2&);

/// Counts the calls, and offers value alone or both.
struct Counted {
  double operator()(const Vec2& x) const {
    Vec2 unused;
    return (*this)(x, unused);
  }
  double operator()(const Vec2& x, Vec2& gradient) const {
    ++calls;
    return function(x, gradient);
  }
  TestFunction function;
  mutable int calls = 0;
};

void expect_minimum(TestFunction function, const Vec2& start, const Vec2& expected) {
  const Counted for_powell{function}, for_bfgs{function};
  const Minimum<2> powell = minimise_powell<2>(for_powell, start);
  const Minimum<2> bfgs = minimise_bfgs<2>(for_bfgs, start);
  for (const auto& [minimum, calls] : {std::pair{powell, for_powell.calls}, {bfgs, for_bfgs.calls}}) {
    EXPECT_TRUE(minimum.converged);
    EXPECT_LT((minimum.x - expected).norm(), 1e-5);
    EXPECT_LT(minimum.value, 1e-11);
    EXPECT_EQ(minimum.evaluations, calls);
    EXPECT_LT(minimum.evaluations, 1000);
    EXPECT_EQ(minimum.value, Counted{function}(minimum.x));
  }
  EXPECT_LT(bfgs.evaluations, powell.evaluations) << "the gradient is worth something";
}

TEST(Minimisers, FindRosenbrocksMinimum) {
  expect_minimum(rosenbrock, Vec2(-1.2, 1), Vec2(1, 1));
  expect_minimum(rosenbrock, Vec2(3, -2), Vec2(1, 1));
}

TEST(Minimisers, FindBealesMinimum) {
  expect_minimum(beale, Vec2(1, 1), Vec2(3, 0.5));
  expect_minimum(beale, Vec2(0, 0), Vec2(3, 0.5));
}

TEST(Minimisers, StayAtAMinimum) {
  expect_minimum(rosenbrock, Vec2(1, 1), Vec2(1, 1));
}

TEST(Minimisers, SayWhenTheyHaveNotConverged) {
  const MinimiserOptions hasty{.max_iterations = 2};
  EXPECT_FALSE(minimise_powell<2>(Counted{rosenbrock}, Vec2(-1.2, 1), hasty).converged);
  EXPECT_FALSE(minimise_bfgs<2>(Counted{rosenbrock}, Vec2(-1.2, 1), hasty).converged);
}

/// x^T M x / 2 - b x with the eigenvalues of M from 1 to `condition`, in N variables.
template <int N>
void expect_minimum_of_quadratic(std::mt19937& random, double condition) {
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;
  std::normal_distribution<double> normal;
  const Matrix Q = testing::random_orthogonal(random, N);
  Vector eigenvalues;
  for (int i = 0; i < N; ++i) eigenvalues[i] = std::pow(condition, i / (N - 1.0));
  const Matrix M = Q * eigenvalues.asDiagonal() * Q.transpose();
  const Vector expected = Vector::NullaryExpr([&] { return normal(random); }), b = M * expected;
  const auto value = [&](const Vector& x) { return 0.5 * x.dot(M * x) - b.dot(x); };
  const auto with_gradient = [&](const Vector& x, Vector& gradient) {
    gradient = M * x - b;
    return value(x);
  };
  const Vector start = Vector::Zero();
  const Minimum<N> powell = minimise_powell<N>(value, start), bfgs = minimise_bfgs<N>(with_gradient, start);
  // A value above the minimum by d means a point off by at most sqrt(2 d), the least eigenvalue being 1. d is
  // the tolerance's share of what was gained, or rounding: some 1e-14 of it.
  const double bound = 10 * std::sqrt(2e-14 * -value(expected));
  for (const Minimum<N>& minimum : {powell, bfgs}) {
    EXPECT_TRUE(minimum.converged);
    EXPECT_LT((minimum.x - expected).norm(), bound) << N << " variables, condition " << condition;
  }
}

TEST(Minimisers, FindTheMinimumOfQuadraticForms) {
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i)
    for (const double condition : {1.0, 10.0, 1000.0}) {
      expect_minimum_of_quadratic<2>(random, condition);
      expect_minimum_of_quadratic<3>(random, condition);
      expect_minimum_of_quadratic<5>(random, condition);
    }
}

TEST(Minimisers, ABracketHoldsALowerPlaceBetweenItsEnds) {
  for (const double centre : {-40.0, -0.1, 0.0, 0.2, 1.0, 300.0}) {
    const auto f = [&](double t) { return std::cosh(0.01 * (t - centre)); };
    const Bracket b = bracket_minimum(f, f(0), 1);
    EXPECT_GT((b.middle.t - b.first.t) * (b.last.t - b.middle.t), 0);
    EXPECT_LE(b.middle.value, std::min(b.first.value, b.last.value));
    EXPECT_NEAR(brent_minimum(f, b, 1e-9, 1e-9).t, centre, 1e-5);
  }
}

TEST(Minimisers, WolfePointFallsAndFlattens) {
  for (const double length : {1e-3, 0.3, 1.0, 50.0, 1e4}) {
    const auto f = [&](double t, double& rate) {
      rate = 2 * (t - length);
      return (t - length) * (t - length);
    };
    const LineMinimum at = wolfe_point(f, length * length, -2 * length);
    EXPECT_GT(at.t, 0);
    EXPECT_LT(at.value, length * length);
    EXPECT_GE(2 * (at.t - length), -0.9 * 2 * length);
  }
  const auto uphill = [](double t, double& rate) {
    rate = 1;
    return t;
  };
  EXPECT_EQ(wolfe_point(uphill, 0, -1).t, 0);
}

// Both stop where the sum exceeds its minimum by the tolerance's share of what was gained, |R y|^2, or by its
// own rounding: off by a value of d means off by at most sqrt(d) / s, s the smaller damped singular value.
TEST(TangentialMinimum, IsTheSameByEachMinimiserWhereWellPosed) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> exponent(-1.5, 1);
  for (const double lambda : {0.1, 1e-6})
    for (int i = 0; i < 500; ++i) {
      const double s0 = std::pow(10, exponent(random)), s1 = std::pow(10, exponent(random));
      const TangentialRows<4> rows = testing::rows_with_singular_values(random, s0, s1);
      const TangentialMinimum closed = minimise(rows, lambda, 1, Minimiser::closed_form);
      EXPECT_EQ(closed.evaluations, 1);
      const double least = testing::objective(rows, lambda, closed.y), gained = rows.b.squaredNorm() - least;
      const double bound = 10 * std::sqrt(1e-14 * gained + 1e-15 * rows.b.squaredNorm()) /
                           std::hypot(std::min(s0, s1), lambda);
      for (const Minimiser minimiser : {Minimiser::bfgs, Minimiser::powell}) {
        const TangentialMinimum found = minimise(rows, lambda, 1, minimiser);
        EXPECT_LT((found.y - closed.y).norm(), bound) << name_of(kMinimisers, minimiser);
        EXPECT_EQ(found.confidence, closed.confidence);
        EXPECT_GT(found.evaluations, 3);
        EXPECT_LT(found.evaluations, 200);
      }
    }
}

TEST(TangentialMinimum, NoMinimiserGetsBelowTheClosedForm) {
  std::mt19937 random(3);
  for (const double s1 : {1.0, 1e-3, 1e-6, 0.0})
    for (const double lambda : {0.1, 1e-6, 0.0})
      for (int i = 0; i < 30; ++i) {
        const TangentialRows<4> rows = testing::rows_with_singular_values(random, 2, s1);
        const Vec2 closed = minimise(rows, lambda, 1, Minimiser::closed_form).y;
        const double least = testing::objective(rows, lambda, closed);
        for (const Minimiser minimiser : {Minimiser::bfgs, Minimiser::powell}) {
          const Vec2 y = minimise(rows, lambda, 1, minimiser).y;
          // R y is off by eps |R| |y|, and |y| reaches 1e6 where nothing damps it.
          const double rounding = 4e-15 * (rows.b.norm() + rows.R.norm() * (y.norm() + closed.norm()));
          EXPECT_GE(testing::objective(rows, lambda, y), least - rounding * rows.b.norm());
          EXPECT_LE(testing::objective(rows, lambda, y), rows.b.squaredNorm());
        }
      }
}

TEST(TangentialMinimum, DoesNotDependOnTheUnitOfSpeed) {
  std::mt19937 random(4);
  for (int i = 0; i < 50; ++i) {
    const TangentialRows<4> rows = testing::rows_with_singular_values(random, 2, 0.5);
    TangentialRows<4> in_mm = rows;
    in_mm.b *= 1024;
    for (const Minimiser minimiser : {Minimiser::bfgs, Minimiser::powell}) {
      const TangentialMinimum a = minimise(rows, 0.1, 3, minimiser),
                              b = minimise(in_mm, 0.1, 3 * 1024, minimiser);
      EXPECT_EQ(a.evaluations, b.evaluations);
      EXPECT_EQ(Vec2(1024 * a.y), b.y);
    }
  }
}

TEST(TangentialMinimum, OfAFieldAtRestIsRest) {
  const TangentialRows<2> rows{Eigen::Matrix2d::Identity(), Vec2::Zero()};
  for (const Named<Minimiser>& minimiser : kMinimisers)
    EXPECT_LT(minimise(rows, 0.1, 0, minimiser.value).y.norm(), 1e-6) << minimiser.name;
}

/// What a method would answer if it solved its least squares by another minimiser.
SurfaceVelocities velocities_by(Minimiser minimiser, const Field& field, std::string_view method,
                                const std::vector<Vec3>& points) {
  const VelocityOptions options;
  const std::vector<double> area(points.size(), 0.0);
  const VertexRings rings{.start = std::vector<int>(points.size() + 1, 0), .neighbour = {}};
  SurfaceVelocities result;
  evaluate_pointwise(field, {points, area, rings}, options, result.sized(points.size()),
                     [&](const Vec3& /*x*/, const Jet& jet) {
                       const TangentBasis basis = tangent_basis(jet.g.normalized());
                       const Vec3 v_n = normal_velocity(jet, options);
                       const auto solved = [&](const auto& rows) {
                         const double fastest = jet.fastest_in_reach;
                         const TangentialMinimum minimum =
                             minimise(rows, options.damping, fastest, minimiser);
                         return PointVelocity{v_n + limited(basis * minimum.y, options.speed_limit * fastest),
                                              minimum.confidence};
                       };
                       const double L = jet.length_scale;
                       const TangentialRows<2> total = total_rows(jet, basis, v_n, L),
                                               curvature = curvature_rows(jet, basis, v_n, L);
                       if (method == "total") return solved(total);
                       return method == "curvature" ? solved(stacked(total, curvature)) : solved(curvature);
                     });
  return result;
}

/// The body of seven, with random velocities.
ParticleField tumbling_body(unsigned seed) {
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(seed);
  testing::set_velocities(body.particles, [&](const Vec3&) { return testing::random_vector(random, 1); });
  return ParticleField(body.particles, body.threshold, 0);
}

// The same velocities by each minimiser, wherever the equations say enough.
TEST(TangentialMinimum, GivesTheSameVelocitiesOnTheBodyOfSeven) {
  const ParticleField field = tumbling_body(5);
  const std::vector<Vec3> points = testing::surface_points(field, 400, 1);
  for (const char* method : {"total", "curvature", "curvature-only"}) {
    const SurfaceVelocities closed = testing::velocities_at(field, method, points, {});
    EXPECT_EQ(velocities_by(Minimiser::closed_form, field, method, points).velocity, closed.velocity);
    for (const Minimiser minimiser : {Minimiser::bfgs, Minimiser::powell}) {
      const SurfaceVelocities found = velocities_by(minimiser, field, method, points);
      EXPECT_EQ(found.confidence, closed.confidence);
      EXPECT_NE(found.velocity, closed.velocity) << "another way to it, with another rounding";
      std::size_t compared = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (closed.confidence[i] < 0.9) continue;
        ++compared;
        EXPECT_LT((found.velocity[i] - closed.velocity[i]).norm(), 1e-5 * field.fastest_speed())
            << method << ", " << name_of(kMinimisers, minimiser);
      }
      EXPECT_GT(compared, 40u) << method;
    }
  }
}

TEST(TangentialMinimum, LooseSearchesStayNearTheirStart) {
  std::mt19937 random(6);
  for (int i = 0; i < 50; ++i) {
    const TangentialRows<4> rows = testing::rows_with_singular_values(random, 2, 0.01);
    const Vec2 closed = minimise(rows, 0, 1, Minimiser::closed_form).y;
    const double least = testing::objective(rows, 0, closed);
    for (const Minimiser minimiser : {Minimiser::bfgs, Minimiser::powell}) {
      const TangentialMinimum tight = minimise(rows, 0, 1, minimiser, closed),
                              loose = minimise(rows, 0, 1, minimiser, Vec2::Zero(),
                                               {.value_tolerance = 0.5, .line_tolerance = 0.7});
      EXPECT_LT((tight.y - closed).norm(), 1e-3 * (1 + closed.norm())) << "it is there already";
      EXPECT_LT(loose.evaluations, minimise(rows, 0, 1, minimiser).evaluations);
      EXPECT_GE(testing::objective(rows, 0, loose.y), least * (1 - 1e-12));
    }
  }
}

SurfaceVelocities by_search(const VelocityFunction& velocity, const Field& field,
                            const std::vector<Vec3>& points) {
  return testing::velocities_at(field, velocity, points, {.damping = 1e-6, .speed_limit = 4});
}

TEST(SearchedCurvature, StartsWhereItIsTold) {
  const ParticleField field = tumbling_body(7);
  const std::vector<Vec3> points = testing::surface_points(field, 100, 2);
  const SurfaceVelocities normal = by_search(evaluate_normal, field, points),
                          total = by_search(evaluate_total, field, points),
                          curvature = by_search(evaluate_curvature, field, points);
  EXPECT_EQ(by_search(searched_curvature({}), field, points).velocity, curvature.velocity);
  // A gain that would have to be the whole sum: BFGS stops where it starts.
  const auto stuck = [&](SearchStart start) {
    return searched_curvature({.minimiser = Minimiser::bfgs, .start = start, .tolerance = 1e9});
  };
  const SurfaceVelocities from_zero = by_search(stuck(SearchStart::zero), field, points),
                          from_last = by_search(stuck(SearchStart::last), field, points),
                          from_total = by_search(stuck(SearchStart::total), field, points);
  EXPECT_EQ(from_last.velocity, from_zero.velocity) << "there was none before";
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LT((from_zero.velocity[i] - normal.velocity[i]).norm(), 1e-12);
    EXPECT_LT((from_total.velocity[i] - total.velocity[i]).norm(), 1e-9);
  }
}

TEST(SearchedCurvature, GoesOnFromTheLastVelocity) {
  const ParticleField field = tumbling_body(8);
  const std::vector<Vec3> points = testing::surface_points(field, 100, 3);
  // One iteration of steepest descent at a time, which the tolerance of 0.05 ends early: again and again from
  // where it was, the sum falls.
  const VelocityFunction search =
      searched_curvature({.minimiser = Minimiser::bfgs, .start = SearchStart::last, .tolerance = 0.05});
  const SurfaceVelocities first = by_search(search, field, points);
  SurfaceVelocities later = first;
  for (int i = 0; i < 3; ++i) later = by_search(search, field, points);
  const SurfaceVelocities goal = by_search(evaluate_curvature, field, points);
  const auto off = [&](const SurfaceVelocities& found) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) sum += (found.velocity[i] - goal.velocity[i]).norm();
    return sum;
  };
  EXPECT_GT(off(first), 1e-3);
  EXPECT_LT(off(later), 0.9 * off(first));
}

}  // namespace
}  // namespace kappaflow
