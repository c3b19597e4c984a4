#include "core/body_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kappaflow {
namespace {

BodyMotion ramp() {
  BodyMotion motion;
  motion.keys = {{0.5, Vec3(1, 0, 0), 0}, {1.5, Vec3(3, -1, 0), 2}, {2, Vec3(3, -1, 0.5), -1}};
  motion.axis = Vec3(1, 2, 2) / 3;
  motion.point = Vec3(0.3, -0.2, 0.7);
  return motion;
}

TEST(BodyMotion, AtRestNothingMoves) {
  const BodyMotion rest;
  EXPECT_TRUE(rest.at_rest());
  EXPECT_EQ(rest.pose(3) * Vec3(1, 2, 3), Vec3(1, 2, 3));
  EXPECT_EQ(rest.velocity(3).at(Vec3(1, 2, 3)), Vec3(0, 0, 0));
}

TEST(BodyMotion, ConstantVelocityAndAQuarterTurn) {
  BodyMotion motion;
  motion.keys = {{0, Vec3(2, 0, 0), std::numbers::pi}};
  motion.point = Vec3(1, 1, 0);
  EXPECT_LT((motion.pose(0.5) * Vec3(2, 1, 5) - Vec3(2, 2, 5)).norm(), 1e-14);
  EXPECT_LT((motion.pose(-0.5) * Vec3(2, 1, 5) - Vec3(0, 0, 5)).norm(), 1e-14);
}

TEST(BodyMotion, PoseStartsAtRestAndItsDerivativeIsTheVelocity) {
  const BodyMotion motion = ramp();
  const Vec3 x(0.4, 1.2, -0.8);
  EXPECT_LT((motion.pose(0) * x - x).norm(), 1e-14);
  const double d = 1e-5;
  for (const double t : {-1.0, 0.2, 0.7, 1.2, 1.7, 2.5}) {
    const Vec3 difference = (motion.pose(t + d) * x - motion.pose(t - d) * x) / (2 * d);
    EXPECT_LT((difference - motion.velocity(t).at(motion.pose(t) * x)).norm(), 1e-8) << t;
    EXPECT_LT((motion.pose(t).inverse(motion.pose(t) * x) - x).norm(), 1e-14);
  }
}

// Between the keys the velocity is linear: the path is the trapezoidal sum, 0.5 * 1 + 1 * 2 + 0.5 * 3 at t
// = 2.
TEST(BodyMotion, PathIsTheIntegralOfTheVelocity) {
  BodyMotion motion = ramp();
  for (BodyMotion::Key& key : motion.keys) key.angular_velocity = 0;
  EXPECT_NEAR((motion.pose(2) * Vec3::Zero()).x(), 4, 1e-14);
  EXPECT_NEAR((motion.pose(3) * Vec3::Zero()).x(), 7, 1e-14);
  EXPECT_NEAR((motion.pose(1) * Vec3::Zero()).x(), 0.5 + 0.5 * (1 + 2) / 2, 1e-14);
}

}  // namespace
}  // namespace kappaflow
