#include "tools/pictures/hiding_walls.h"

#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkCleanPolyData.h>
#include <vtkCubeSource.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkSphereSource.h>
#include <vtkTriangleFilter.h>

#include <array>

namespace kappaflow {
namespace {

template <class Source>
vtkSmartPointer<vtkPolyData> triangles_of(Source& source) {
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputConnection(source.GetOutputPort());
  triangles->Update();
  return triangles->GetOutput();
}

vtkSmartPointer<vtkPolyData> ball(const Vec3& centre, double radius) {
  vtkNew<vtkSphereSource> source;
  source->SetCenter(centre[0], centre[1], centre[2]);
  source->SetRadius(radius);
  source->SetThetaResolution(24);
  source->SetPhiResolution(24);
  return triangles_of(*source);
}

/// The mean height of the triangles with that flag.
Vec3 centre_of(vtkPolyData& walls, const std::vector<std::uint32_t>& flag, std::uint32_t value) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (vtkIdType t = 0; t < walls.GetNumberOfCells(); ++t) {
    if (flag[static_cast<std::size_t>(t)] != value) continue;
    for (int c = 0; c < 3; ++c) sum += Vec3(walls.GetPoint(walls.GetCell(t)->GetPointId(c))) / 3;
    ++count;
  }
  return sum / count;
}

std::vector<std::uint32_t> hiding_from(vtkPolyData& walls, vtkPolyData& liquid, const Vec3& viewer) {
  return hiding_triangles(walls, liquid, std::array{viewer});
}

TEST(HidingWalls, TheNearSideOfATankAndNotItsFloor) {
  vtkNew<vtkCubeSource> cube;  // of edge 1 around the origin
  const auto tank = triangles_of(*cube);
  const auto liquid = ball(Vec3(0, -0.2, 0), 0.25);
  const std::vector<std::uint32_t> hiding = hiding_from(*tank, *liquid, Vec3(0, 0.1, 1));
  ASSERT_EQ(hiding.size(), 12u);
  EXPECT_EQ(std::ranges::count(hiding, 1), 2) << "two triangles of the side at z = 1/2";
  EXPECT_LT((centre_of(*tank, hiding, 1) - Vec3(0, 0, 0.5)).norm(), 1e-6);
  EXPECT_EQ(part_of(*tank, hiding, true)->GetNumberOfCells(), 2);
  EXPECT_EQ(part_of(*tank, hiding, false)->GetNumberOfCells(), 10);
  EXPECT_EQ(sharp_edges(*part_of(*tank, hiding, true))->GetNumberOfLines(), 4);
}

TEST(HidingWalls, EachViewerHasABit) {
  vtkNew<vtkCubeSource> cube;
  const auto tank = triangles_of(*cube);
  const auto liquid = ball(Vec3(0, -0.2, 0), 0.25);
  const std::vector<Vec3> viewers{Vec3(0, 0.1, 1), Vec3(1, 0.1, 0), Vec3(0, 1, 0)};
  const std::vector<std::uint32_t> together = hiding_triangles(*tank, *liquid, viewers);
  for (std::size_t d = 0; d < viewers.size(); ++d) {
    const std::vector<std::uint32_t> alone = hiding_from(*tank, *liquid, viewers[d]);
    for (std::size_t t = 0; t < alone.size(); ++t) EXPECT_EQ(together[t] >> d & 1, alone[t]) << t;
  }
}

TEST(HidingWalls, AFloorBelowHidesNothing) {
  vtkNew<vtkCubeSource> slab;
  slab->SetYLength(0.1);
  const auto floor = triangles_of(*slab);
  const auto liquid = ball(Vec3(0, 0.35, 0), 0.25);
  EXPECT_EQ(std::ranges::count(hiding_from(*floor, *liquid, Vec3(0.9, 0.65, 1)), 1), 0);
}

TEST(HidingWalls, ASmoothFaceIsSeenThroughAsAWhole) {
  const auto shell = ball(Vec3::Zero(), 1), liquid = ball(Vec3::Zero(), 0.3);
  const std::vector<std::uint32_t> hiding = hiding_from(*shell, *liquid, Vec3(0, 0, 1));
  EXPECT_EQ(static_cast<vtkIdType>(std::ranges::count(hiding, 1)), shell->GetNumberOfCells());
}

TEST(HidingWalls, NothingHidesNothing) {
  vtkNew<vtkPolyData> nothing;
  const auto liquid = ball(Vec3::Zero(), 0.3);
  EXPECT_TRUE(hiding_from(*nothing, *liquid, Vec3(0, 0, 1)).empty());
  EXPECT_EQ(std::ranges::count(hiding_from(*liquid, *nothing, Vec3(0, 0, 1)), 1), 0);
}

}  // namespace
}  // namespace kappaflow
