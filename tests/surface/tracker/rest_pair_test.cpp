// Two rest positions in turns: how old each is, how they blend, and that neither is older than it may be.
#include "surface/tracker/rest_pair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1, kSpeed = 0.3, kFrameTime = 0.1;
constexpr int kInterval = 3;

/// A ball of particles that moves along x without turning.
Particles moving_ball(double time) {
  Particles particles;
  particles.time = time;
  for (int k = 0; k < 7 * 7 * 7; ++k) {
    const Vec3 start = kSpacing * Vec3(k % 7 - 3, k / 7 % 7 - 3, k / 49 - 3);
    if (start.norm() > 0.3) continue;
    particles.id.push_back(k);
    particles.position.push_back(start + Vec3(time * kSpeed, 0, 0));
    particles.velocity.emplace_back(kSpeed, 0, 0);
  }
  return particles;
}

// The ball moves as a whole, so that a vertex has gone as far as its rest position is old.
TEST(RestPair, EachIsAsOldAsItsLastReset) {
  TrackedSurfaces surfaces(moving_ball(0));
  RestPair pair(surfaces, kInterval);
  const double left = pair.box(0).lower.x();
  for (int frame = 0; frame <= 4 * kInterval; ++frame) {
    if (frame > 0) surfaces.advance(moving_ball(frame * kFrameTime));
    pair.update(surfaces, frame);
    const int resets = frame / kInterval;  // of both
    const int age[] = {frame - (resets - resets % 2) * kInterval,
                       frame - (resets == 0 ? 0 : (resets - 1 + resets % 2) * kInterval)};
    const TriangleMesh& mesh = surfaces.mesh();
    for (const int which : {0, 1}) {
      const auto rest = mesh.array<Vec3>(RestPair::kNames[which]);
      double furthest = 0;
      for (std::size_t v = 0; v < rest.size(); ++v) {
        const Vec3 moved = mesh.position[v] - rest[v];
        furthest = std::max(furthest, (moved - Vec3(age[which] * kFrameTime * kSpeed, 0, 0)).norm());
      }
      EXPECT_LT(furthest, 0.02) << "frame " << frame << ", " << RestPair::kNames[which];
      EXPECT_NEAR(pair.box(which).lower.x(), left + (frame - age[which]) * kFrameTime * kSpeed, 0.03);
    }
    const double weight = mesh.array<double>("rest_2_weight")[0];
    EXPECT_GE(weight, 0);
    EXPECT_LE(weight, 1);
    if (frame % kInterval == 0 && frame > 0) {
      EXPECT_EQ(weight, resets % 2 == 1 ? 0 : 1) << "what is reset is not seen, frame " << frame;
    }
    const double seen_age = weight > 0.5 ? age[1] : age[0];
    EXPECT_LE(seen_age, 1.5 * kInterval) << "what is seen most";
  }
}

TEST(RestPair, WeightsChangeBySteadySteps) {
  TrackedSurfaces surfaces(moving_ball(0));
  RestPair pair(surfaces, kInterval);
  double before = 0;
  for (int frame = 0; frame <= 2 * kInterval; ++frame) {
    pair.update(surfaces, frame);
    const double weight = surfaces.mesh().array<double>("rest_2_weight")[0];
    if (frame > 0) {
      EXPECT_NEAR(std::abs(weight - before), 1.0 / kInterval, 1e-12);
    }
    before = weight;
  }
}

}  // namespace
}  // namespace kappaflow
