// The shear rate that a particle sees: exact for linear flows, at free surfaces and walls.
#include "solver/shear_rate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr float kSpacing = 0.1f;

std::vector<float> rates(const Liquid& liquid, float slip = 1) {
  std::vector<float> result;
  for (std::size_t i = 0; i < liquid.particles.size(); ++i)
    result.push_back(shear_rate(i, liquid.particles, liquid.lists, liquid.wall_sums,
                                liquid.particles.velocity, kSpacing, slip));
  return result;
}

Liquid moving(const std::vector<Vec3>& points, const Mat3& gradient) {
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.emplace_back(gradient * x + Vec3(3, 4, 5));
  return Liquid(points, velocity, kSpacing);
}

// A block from y = 0 on over a wall, wide enough that its middle does not see its sides.
Liquid over_wall(const std::function<Vec3(const Vec3&)>& velocity_at, const BodyMotion& motion = {}) {
  const auto points = test::block({-0.5, 0, -0.5}, {0.5, 0.5, 0.5}, 0.1);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points) velocity.push_back(velocity_at(x));
  const auto floor = solid_walls(std::vector{test::box_surface({-1, -0.5, -1}, {1, 0, 1})});
  return Liquid(points, velocity, kSpacing, sample_walls(floor, 0.1), motion);
}

/// Of the middle of the layer that is the k-th over the wall: the largest difference from `expected`.
float difference(const Liquid& liquid, const std::vector<float>& rate, int layer, float expected) {
  float worst = 0;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    const Vec4f& x = liquid.particles.position[i];
    if (std::max(std::abs(x[0]), std::abs(x[2])) > 0.26f) continue;
    if (std::abs(x[1] - (0.05f + 0.1f * static_cast<float>(layer))) > 0.02f) continue;
    worst = std::max(worst, std::abs(rate[i] - expected));
  }
  return worst;
}

TEST(ShearRate, IsExactForLinearFlowUpToTheFreeSurface) {
  Mat3 gradient;
  gradient << 1, 2, -1, 0.5, -3, 1, 0.3, 0.7, 2;  // without divergence
  const Mat3 strain = (gradient + gradient.transpose()) / 2;
  const double exact = std::sqrt(2 * strain.squaredNorm());
  const Liquid liquid = moving(test::blob(0.35, 0.1), gradient);
  for (const float rate : rates(liquid)) EXPECT_NEAR(rate, exact, 0.01 * exact);
}

TEST(ShearRate, RigidMotionsAndChangesOfVolumeHaveNone) {
  Mat3 gradient;
  gradient << 1, -2, 3, 2, 1, -4, -3, 4, 1;
  const Liquid liquid = moving(test::blob(0.35, 0.1), gradient);
  for (const float rate : rates(liquid)) EXPECT_LT(rate, 0.02);
}

// Of 1 m/s at half a metre over the wall, parabola or line: the derivative at each layer.
TEST(ShearRate, SeesAWallWithoutSlip) {
  const auto parabola = [](const Vec3& x) { return Vec3(4 * x.y() * (1 - x.y()), 0, 0); };
  const Liquid liquid = over_wall(parabola);
  const auto rate = rates(liquid);
  for (const int layer : {0, 1, 2})
    EXPECT_LT(difference(liquid, rate, layer, 4 - 8 * (0.05f + 0.1f * static_cast<float>(layer))), 0.25f)
        << layer;
}

TEST(ShearRate, SeesThatAWallMoves) {
  BodyMotion motion;
  motion.keys.push_back({0, Vec3(2, 0, 0), 0});
  const Liquid liquid = over_wall([](const Vec3& x) { return Vec3(2 - 3 * x.y(), 0, 0); }, motion);
  const auto rate = rates(liquid);
  for (const int layer : {0, 1}) EXPECT_LT(difference(liquid, rate, layer, 3), 0.15f) << layer;
}

TEST(ShearRate, FreeSlipAlongAWallIsNoShear) {
  const Liquid liquid = over_wall([](const Vec3&) { return Vec3(2, 0, 1); });
  EXPECT_LT(difference(liquid, rates(liquid, 0), 0, 0), 1e-3f);
  EXPECT_GT(difference(liquid, rates(liquid, 1), 0, 0), 10.0f);
}

TEST(ShearRate, OfFewParticlesIsFinite) {
  const std::vector<Vec3> one{Vec3::Zero()}, two{Vec3::Zero(), Vec3(0.1, 0, 0)},
      plane{Vec3::Zero(), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0), Vec3(0.1, 0.1, 0)};
  Mat3 gradient = Mat3::Zero();
  gradient(0, 1) = 1;
  for (const auto& points : {one, two, plane})
    for (const float rate : rates(moving(points, gradient))) EXPECT_LT(rate, 1.01f);
  EXPECT_NEAR(rates(moving(plane, gradient))[0], 1, 0.02) << "what lies in the plane is seen";
}

}  // namespace
}  // namespace kappaflow
