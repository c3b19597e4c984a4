// Means of the particles' values near points.
#include "surface/measure/particle_means.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace kappaflow {
namespace {

TEST(ParticleMeans, AreShepards) {
  const std::array<Vec3, 3> position{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(9, 0, 0)};
  const std::array<float, 3> value{10, 20, 1000};
  const std::array<Vec3, 3> points{Vec3(0.5, 0, 0), Vec3(0.25, 0, 0), Vec3(0, 50, 0)};
  const auto means = particle_means(points, position, value, 2, -1);
  EXPECT_DOUBLE_EQ(means[0], 15);
  const double near = std::pow(1 - 0.0625 / 4, 3), far = std::pow(1 - 0.5625 / 4, 3);
  EXPECT_NEAR(means[1], (10 * near + 20 * far) / (near + far), 1e-12);
  EXPECT_EQ(means[2], -1);
}

TEST(ParticleMeans, OfEqualValuesAreThese) {
  std::vector<Vec3> position;
  for (int i = 0; i < 200; ++i) position.emplace_back(std::sin(i), std::sin(2.0 * i), std::sin(3.0 * i));
  const std::vector<float> value(position.size(), 7);
  for (const double mean : particle_means(position, position, value, 0.3, 0)) EXPECT_NEAR(mean, 7, 1e-12);
}

}  // namespace
}  // namespace kappaflow
