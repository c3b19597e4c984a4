#include "core/particles.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/errors.h"

namespace kappaflow {
namespace {

Particles two_particles() {
  return {.time = 0,
          .id = {3, 7},
          .position = {Vec3::Zero(), Vec3::Ones()},
          .velocity = {Vec3::Zero(), Vec3::Zero()}};
}

TEST(Particles, CheckAcceptsWhatIsSound) {
  EXPECT_NO_THROW(check_particles(two_particles()));
}

TEST(Particles, CheckRefusesMissingEntriesRepeatedIdsAndNan) {
  Particles missing = two_particles();
  missing.velocity.pop_back();
  EXPECT_THROW(check_particles(missing), InvalidInput);

  Particles repeated = two_particles();
  repeated.id = {3, 3};
  EXPECT_THROW(check_particles(repeated), InvalidInput);

  Particles not_finite = two_particles();
  not_finite.position[1].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(check_particles(not_finite), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
