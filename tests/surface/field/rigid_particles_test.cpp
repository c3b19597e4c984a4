#include "surface/field/rigid_particles.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/errors.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

const SteadyMotion kMotion{.velocity = Vec3(0.3, -0.1, 0.2), .angular_velocity = Vec3(0.4, 1.1, -2)};

RigidParticles seven(double t0, double t1) {
  const testing::Body body = testing::read_body_of_seven();
  return {body.particles, body.threshold, kMotion, t0, t1};
}

TEST(SteadyMotion, AWholeTurnLeadsBack) {
  const SteadyMotion turn{.angular_velocity = 2 * std::numbers::pi * Vec3(1, 2, 2) / 3};
  const Vec3 x(0.4, -0.3, 1);
  EXPECT_LT((turn.position(x, 1) - x).norm(), 4e-15);
  EXPECT_GT((turn.position(x, 0.5) - x).norm(), 0.5);
  EXPECT_EQ(SteadyMotion{}.position(x, 3), x);
}

TEST(RigidParticles, TheFieldMovesWithTheBody) {
  RigidParticles motion = seven(0.2, 0.7);
  RigidParticles start = seven(0, 1);
  for (const double t : {0.2, 0.45, 0.7})
    for (const Vec3& x0 : {Vec3(0.5, 0.1, 0.3), Vec3(-0.4, -0.5, 0.2), Vec3(0.1, 0.6, -0.4)})
      EXPECT_NEAR(motion.at(t)->value_and_gradient(kMotion.position(x0, t)).f,
                  start.at(0)->value_and_gradient(x0).f, 1e-14);
}

TEST(RigidParticles, TimeDerivativesAreThoseOfTheMovingField) {
  RigidParticles motion = seven(0, 1);
  const Vec3 x(0.5, 0.1, 0.3);
  const double t = 0.4, h = 1e-5;
  const double f_t =
      (motion.at(t + h)->value_and_gradient(x).f - motion.at(t - h)->value_and_gradient(x).f) / (2 * h);
  EXPECT_NEAR(motion.at(t)->jet(x).f_t, f_t, 1e-8 * std::abs(f_t) + 1e-8);  // the difference's own error
}

TEST(RigidParticles, TimeMustGoForward) {
  EXPECT_THROW(seven(1, 1), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
