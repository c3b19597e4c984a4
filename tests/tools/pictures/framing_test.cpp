#include "tools/pictures/framing.h"

#include <gtest/gtest.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <array>

namespace kappaflow {
namespace {

vtkSmartPointer<vtkPolyData> points_at(const std::vector<Vec3>& places) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();
  for (const Vec3& x : places) points->InsertNextPoint(x.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  return data;
}

TEST(Framing, TheViewsAxesAreRightUpAndTowardsTheViewer) {
  const Mat3 axes = view_axes({Vec3(0, 0, 3), Vec3(0, 2, 1)});
  EXPECT_LT((axes - Mat3::Identity()).norm(), 1e-15);
  const Mat3 from_right = view_axes({Vec3(1, 0, 0), Vec3(0, 0, 1)});
  EXPECT_LT((from_right.row(0).transpose() - Vec3(0, 1, 0)).norm(), 1e-15);
  EXPECT_LT((from_right.row(1).transpose() - Vec3(0, 0, 1)).norm(), 1e-15);
}

TEST(Framing, IsTheBoxOfAllPartsButForSpray) {
  std::vector<Vec3> block, spray{Vec3(50, 0, 0)};
  for (int i = 0; i <= 1000; ++i) block.emplace_back(i * 1e-3, 2 + i * 2e-3, -i * 1e-3);
  const auto a = points_at(block), b = points_at(spray);
  const std::array<vtkPolyData*, 3> parts{a.Get(), nullptr, b.Get()};
  const View view{Vec3(0, 0, 1), Vec3(0, 1, 0)};
  const Framing whole = framing(parts, view, 0), liquid = framing(parts, view, 0.002);
  EXPECT_LT((whole.centre - Vec3(25, 2, -0.5)).norm(), 1e-12);
  EXPECT_LT((whole.half - Vec3(25, 2, 0.5)).norm(), 1e-12);
  EXPECT_LT((liquid.centre - Vec3(0.5, 3, -0.5)).norm(), 0.01);
  EXPECT_LT((liquid.half - Vec3(0.5, 1, 0.5)).norm(), 0.01);
  EXPECT_EQ(framing({}, view, 0).half, Vec3(1, 1, 1)) << "of nothing";
}

TEST(Framing, ACameraFollowsSmoothlyAndForeseesWhatIsLarge) {
  std::vector<Framing> jump;
  for (int k = 0; k < 20; ++k) jump.push_back({Vec3(k < 10 ? 0 : 1, 0, 0), Vec3(k == 12 ? 3 : 1, 1, 1)});
  const std::vector<Framing> way = followed(jump, 4);
  ASSERT_EQ(way.size(), jump.size());
  for (std::size_t k = 1; k < way.size(); ++k) {
    EXPECT_GE(way[k].centre.x(), way[k - 1].centre.x());
    EXPECT_LT(way[k].centre.x() - way[k - 1].centre.x(), 0.25);
  }
  EXPECT_NEAR(way.front().centre.x(), 0, 1e-15);
  EXPECT_NEAR(way.back().centre.x(), 1, 1e-15);
  EXPECT_NEAR(way[12].half.x(), 3, 1e-12) << "all of it fits";
  EXPECT_NEAR(way[0].half.x(), 1, 1e-12);
  EXPECT_EQ(followed(jump, 0)[12].half.x(), 3) << "a picture alone is that of its frame";
}

}  // namespace
}  // namespace kappaflow
