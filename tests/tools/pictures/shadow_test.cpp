#include "tools/pictures/shadow.h"

#include <gtest/gtest.h>
#include <vtkSmartPointer.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace kappaflow {
namespace {

constexpr int kPixels = 200;
constexpr double kFloor = -0.5, kPlate = 0.3, kHalf = 0.3;  // the plate is a square above the floor [m]
const Vec3 kKey(0.6, 0, 0.8);

/// What a camera without perspective sees that looks against `towards`; depth(x) is along the ray through
/// the middle of the pixel at x.
template <class Depth>
DepthImage seen_along(const Mat3& axes, const Depth& depth) {
  DepthImage image{kPixels, kPixels, {}, Eigen::Matrix4d::Identity()};
  image.to_image.topLeftCorner<3, 3>() = 0.5 * axes;  // two metres on either side
  image.to_image.row(2) *= -1;
  image.to_image(3, 3) = 1;
  for (int y = 0; y < kPixels; ++y)
    for (int x = 0; x < kPixels; ++x)
      image.depth.push_back(static_cast<float>(
          depth(axes.transpose() * Vec3(4 * (x + 0.5) / kPixels - 2, 4 * (y + 0.5) / kPixels - 2, 0))));
  return image;
}

/// 0 at two metres towards the viewer, 1 at two behind.
double depth_of(const Vec3& place, const Vec3& towards) {
  return 0.5 - 0.25 * place.dot(towards);
}

DepthImage floor_from_above() {
  return seen_along(Mat3::Identity(), [](const Vec3& x) {
    return depth_of({x.x(), x.y(), kFloor}, Vec3::UnitZ());
  });
}

DepthImage plate_from_key() {
  Mat3 axes;
  axes << 0.8, 0, -0.6, 0, 1, 0, kKey.x(), kKey.y(), kKey.z();
  return seen_along(axes, [](const Vec3& x) {
    const Vec3 hit = x + (kPlate - x.z()) / kKey.z() * kKey;
    return std::abs(hit.x()) < kHalf && std::abs(hit.y()) < kHalf ? depth_of(hit, kKey) : 1;
  });
}

class Shadow : public testing::Test {
 protected:
  Shadow() {
    picture->SetDimensions(kPixels, kPixels, 1);
    picture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    auto* const bytes = static_cast<unsigned char*>(picture->GetScalarPointer());
    std::fill_n(bytes, 3 * kPixels * kPixels, static_cast<unsigned char>(200));
  }
  /// The mean brightness around a place of the floor [m].
  double at(double x, double y) const {
    double sum = 0;
    for (int j = -2; j <= 2; ++j)
      for (int i = -2; i <= 2; ++i)
        sum += picture->GetScalarComponentAsDouble(static_cast<int>((x + 2) / 4 * kPixels) + i,
                                                   static_cast<int>((y + 2) / 4 * kPixels) + j, 0, 1);
    return sum / 25;
  }
  vtkSmartPointer<vtkImageData> picture = vtkSmartPointer<vtkImageData>::New();
  const Lighting lighting{kKey, Vec3(0, 0, 1), 0.3, 0.5, 0.2};
};

// The plate is one metre away from the floor along the light, and its shadow 0.6 m beside it.
TEST_F(Shadow, LiesWhereTheLightDoesNotCome) {
  cast_shadows(*picture, floor_from_above(), plate_from_key(), lighting);
  const double left = 1 - 0.5 * 0.8 / (0.3 + 0.2 + 0.5 * 0.8);
  EXPECT_NEAR(at(-0.6, 0), 200 * left, 2) << "in the middle";
  for (const Vec2& beside : {Vec2(0, 0), Vec2(-1.3, 0), Vec2(-0.6, 0.6), Vec2(-0.6, -0.6), Vec2(1.5, 1.5)})
    EXPECT_EQ(at(beside.x(), beside.y()), 200) << beside.transpose();
  const double half = 200 * (1 + left) / 2;
  EXPECT_NEAR(at(-0.6, kHalf), half, 12) << "at its edge";
  EXPECT_NEAR(at(-0.6 - kHalf, 0), half, 12);
  EXPECT_GT(at(-0.6, kHalf + 0.08), half + 10) << "a soft one";
  EXPECT_LT(at(-0.6, kHalf - 0.08), half - 10);
}

TEST_F(Shadow, IsNotOnWhatTurnsAwayNorOnNothing) {
  Lighting from_below = lighting;
  from_below.key = Vec3(0.6, 0, -0.8);
  cast_shadows(*picture, floor_from_above(), plate_from_key(), from_below);
  EXPECT_EQ(at(-0.6, 0), 200) << "the key light does not reach it anyway";
  DepthImage nothing = floor_from_above();
  std::ranges::fill(nothing.depth, 1.0f);
  cast_shadows(*picture, nothing, plate_from_key(), lighting);
  EXPECT_EQ(at(-0.6, 0), 200);
}

}  // namespace
}  // namespace kappaflow
