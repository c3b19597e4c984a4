#include "surface/tracker/rest_grid.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <sstream>

#include "core/saved_state.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

/// A ball of the radius 1 that swirls about the z axis, the faster the nearer to it: the exact motion is
/// known, and shears.
class Swirl final : public Field {
 public:
  static double angular_speed(const Vec3& x) { return 2 / (1 + x.head<2>().squaredNorm()); }
  /// Where what is at x now was a time ago.
  static Vec3 before(const Vec3& x, double time) {
    return Eigen::AngleAxisd(-angular_speed(x) * time, Vec3::UnitZ()) * x;
  }

  double time() const override { return 0; }
  Jet jet(const Vec3&) const override { return {}; }
  ValueAndGradient value_and_gradient(const Vec3& x) const override {
    return {1 - x.norm(), -x.normalized()};
  }
  Bounds bounds() const override { return {Vec3::Constant(-1.5), Vec3::Constant(1.5)}; }
  double length_scale() const override { return 1; }
  double fastest_speed() const override { return 1; }
  std::optional<Vec3> material_velocity(const Vec3& x) const override {
    if (!(x.norm() < 1.5)) return std::nullopt;
    return Vec3(angular_speed(x) * Vec3::UnitZ().cross(x));
  }
};

auto swirling(double t0, double t1) {
  return testing::FunctionMotion(t0, t1, [](double) { return std::make_shared<Swirl>(); });
}

/// Semi-Lagrangian steps of X over the whole cube [-2, 2]^3, without any correction: what RestGrid is to be
/// better than.
class Uncorrected {
 public:
  explicit Uncorrected(double spacing)
      : n_(static_cast<int>(std::lround(4 / spacing)) + 1), spacing_(spacing), rest_(n_ * n_ * n_) {
    for (int p = 0; p < n_ * n_ * n_; ++p) rest_[p] = place(p);
  }
  void step(double dt) {
    std::vector<Vec3> next = rest_;
    for (int p = 0; p < n_ * n_ * n_; ++p) {
      const Vec3 from = Swirl::before(place(p), dt);
      if (place(p).norm() < 1.6) next[p] = at(from);
    }
    rest_ = next;
  }
  Vec3 at(const Vec3& x) const {
    const Vec3 scaled = (x + Vec3::Constant(2)) / spacing_;
    const Eigen::Vector3i c = scaled.array().floor().cast<int>();
    const Vec3 t = scaled - c.cast<double>();
    Vec3 sum = Vec3::Zero();
    for (int i : {0, 1})
      for (int j : {0, 1})
        for (int k : {0, 1})
          sum += std::abs(1 - i - t[0]) * std::abs(1 - j - t[1]) * std::abs(1 - k - t[2]) *
                 rest_[((c[2] + k) * n_ + c[1] + j) * n_ + c[0] + i];
    return sum;
  }

 private:
  Vec3 place(int p) const { return spacing_ * Vec3(p % n_, p / n_ % n_, p / (n_ * n_)) - Vec3::Constant(2); }
  int n_;
  double spacing_;
  std::vector<Vec3> rest_;
};

/// RMS over points of a sphere.
double error_after(double time, double radius, const std::function<Vec3(const Vec3&)>& rest) {
  double sum = 0;
  const int n = 2000;
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.0) / n, r = std::sqrt(1 - z * z), angle = 2.39996323 * i;
    const Vec3 x = radius * Vec3(r * std::cos(angle), r * std::sin(angle), z);
    sum += (rest(x) - Swirl::before(x, time)).squaredNorm();
  }
  return std::sqrt(sum / n);
}

struct Errors {
  double corrected, uncorrected;
};

Errors swirl_errors(double radius, double spacing, int steps) {
  constexpr double kTime = 1.5;
  RestGrid grid(Swirl(), spacing);
  Uncorrected plain(spacing);
  const double dt = kTime / steps;
  for (int s = 0; s < steps; ++s) {
    auto motion = swirling(s * dt, (s + 1) * dt);
    grid.step(motion);
    plain.step(dt);
  }
  return {error_after(kTime, radius, [&](const Vec3& x) { return grid.at(x).value(); }),
          error_after(kTime, radius, [&](const Vec3& x) { return plain.at(x); })};
}

TEST(RestGrid, IsOfSecondOrderWhereSemiLagrangianStepsAreOfFirst) {
  const Errors coarse = swirl_errors(0.6, 0.2, 8), fine = swirl_errors(0.6, 0.1, 16);
  EXPECT_GT(std::log2(coarse.corrected / fine.corrected), 1.8);
  EXPECT_LT(std::log2(coarse.uncorrected / fine.uncorrected), 1.3);
  EXPECT_LT(coarse.corrected, 0.5 * coarse.uncorrected);
  EXPECT_LT(fine.corrected, 0.25 * fine.uncorrected);
}

// On the surface X comes in part from points outside, of which nothing is known but what is inside.
TEST(RestGrid, IsBetterThanSemiLagrangianStepsOnTheSurfaceToo) {
  const Errors errors = swirl_errors(1, 0.1, 16);
  EXPECT_LT(errors.corrected, 0.5 * errors.uncorrected);
}

/// All of X that can be asked for around the ball.
std::vector<Vec3> values(const RestGrid& grid) {
  std::vector<Vec3> result;
  for (double z = -1.4; z < 1.4; z += 0.17)
    for (double y = -1.4; y < 1.4; y += 0.17)
      for (double x = -1.4; x < 1.4; x += 0.17) result.push_back(grid.at({x, y, z}).value_or(Vec3::Zero()));
  return result;
}

std::vector<Vec3> values_with_threads(std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  RestGrid grid(Swirl(), 0.2);
  for (int s = 0; s < 3; ++s) {
    auto motion = swirling(0.1 * s, 0.1 * (s + 1));
    grid.step(motion);
  }
  return values(grid);
}

TEST(RestGrid, SameBitsForAnyNumberOfThreads) {
  EXPECT_EQ(values_with_threads(1), values_with_threads(2));
}

TEST(RestGrid, GoesOnFromASavedState) {
  RestGrid whole(Swirl(), 0.2);
  auto first = swirling(0, 0.1), second = swirling(0.1, 0.2);
  whole.step(first);
  std::stringstream state;
  StateWriter writer(state, little_endian());
  writer(whole);
  RestGrid resumed(Swirl(), 0.2);
  StateReader reader(state);
  reader(resumed);
  whole.step(second);
  resumed.step(second);
  EXPECT_EQ(values(resumed), values(whole));
}

}  // namespace
}  // namespace kappaflow
