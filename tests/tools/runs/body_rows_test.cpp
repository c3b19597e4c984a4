#include "tools/runs/body_rows.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

TEST(BodyRows, AreCentreRotationAndVelocities) {
  BodyState turned;
  turned.pose.rotation = Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix();
  turned.velocity = {Vec3(1, 2, 3), Vec3(-4, 5, 6), Vec3(0.25, 0.5, -1)};
  EXPECT_EQ(bodies_rows(7, 0.28, std::vector{BodyState(), turned}),
            "7,0.28,0,0,0,0,0,0,0,1,0,0,0,0,0,0\n"
            "7,0.28,1,0.25,0.5,-1,0,0,0.707106781187,0.707106781187,1,2,3,-4,5,6\n");
  EXPECT_EQ(split(bodies_header(), ',').size(), 16u);
  EXPECT_EQ(bodies_rows(0, 0, {}), "");
}

TEST(BodyRows, QuaternionsHaveAPositiveRealPart) {
  BodyState turned;
  for (const double angle : {-3.0, 3.0, 4.0, 6.0}) {
    turned.pose.rotation = Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
    const std::vector<std::string> cells = split(bodies_rows(0, 0, {&turned, 1}), ',');
    const double nearest = std::remainder(angle, 2 * std::numbers::pi);
    EXPECT_NEAR(std::stod(cells[6]), std::sin(nearest / 2), 1e-11);
    EXPECT_NEAR(std::stod(cells[9]), std::cos(nearest / 2), 1e-11);
  }
}

}  // namespace
}  // namespace kappaflow
