#include "tools/runs/liquid_metrics.h"

#include <gtest/gtest.h>

#include "scenes/prepared_scene.h"

namespace kappaflow {
namespace {

TEST(LiquidMetrics, PenetrationIsTheDeepestCentreInSpacings) {
  Scene scene;
  scene.walls.emplace_back().shape = BoxShape{{0, 0, 0}, {1, 1, 1}};
  const WallDistance walls(prepare(scene).walls);
  const std::vector<Vec3> outside{{2, 0, 0}, {0.5, 1.001, 0.5}},
      inside{{0.5, 0.98, 0.5}, {0.5, 0.99, 0.5}, {2, 2, 2}};
  EXPECT_EQ(penetration_max(outside, walls, 0.1), 0);
  EXPECT_NEAR(penetration_max(inside, walls, 0.1), 0.2, 1e-12);
  EXPECT_EQ(penetration_max(inside, WallDistance({}), 0.1), 0) << "no walls";
}

TEST(LiquidMetrics, CompressionIsOverTheFluidsOwnDensityAndIgnoresExpansion) {
  FluidOptions two;
  two.more_viscosities = {1};
  two.more_densities = {500};
  const std::vector<float> density{1000, 1010, 450, 515};
  const std::vector<std::uint8_t> fluid{0, 0, 1, 1};
  const Compression c = compression(density, fluid, two);
  EXPECT_NEAR(c.mean, 0.01, 1e-7);
  EXPECT_NEAR(c.max, 0.03, 1e-7);
}

}  // namespace
}  // namespace kappaflow
