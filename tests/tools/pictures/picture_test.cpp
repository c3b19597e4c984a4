#include "tools/pictures/picture.h"

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <Eigen/Geometry>
#include <map>

#include "core/errors.h"
#include "surface/measure/texture.h"
#include "tests/tools/scratch.h"
#include "tools/io/vtp_files.h"
#include "tools/pictures/name_regions.h"

namespace kappaflow {
namespace {

/// A square of two triangles seen from +z, whose rest positions are three by two cubes.
vtkSmartPointer<vtkPolyData> square() {
  TriangleMesh mesh =
      make_triangle_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  mesh.rest_position = {{0, 0, 0.5}, {3, 0, 0.5}, {3, 2, 0.5}, {0, 2, 0.5}};
  SurfaceState state;
  state.normal.assign(4, Vec3::UnitZ());
  state.motion.velocity.assign(4, Vec3::Zero());
  state.motion.confidence.assign(4, 1);
  state.mean_curvature = state.gaussian_curvature = {0, 0, 0, 0};
  return surface_data({0, mesh, state, Checker{Vec3(0, 0, 0), 1}});
}

class Picture : public Scratch {
 protected:
  vtkSmartPointer<vtkImageData> drawn(const PictureStyle& style) {
    const std::vector<Panel> panels{{"square", square()}};
    draw_picture(folder / "a.png", panels, {}, std::nullopt, style);
    vtkNew<vtkPNGReader> reader;
    reader->SetFileName((folder / "a.png").c_str());
    reader->Update();
    return reader->GetOutput();
  }
};

bool is_blue(vtkImageData& image, int x, int y) {
  return image.GetScalarComponentAsDouble(x, y, 0, 2) > image.GetScalarComponentAsDouble(x, y, 0, 0) + 20;
}
bool is_cream(vtkImageData& image, int x, int y) {
  return image.GetScalarComponentAsDouble(x, y, 0, 0) > image.GetScalarComponentAsDouble(x, y, 0, 2) + 20;
}

// Six cubes on two triangles: no vertex colours could tell them apart.
TEST_F(Picture, CheckerIsEvaluatedForEveryPixel) {
  const PictureStyle style{.panel_width = 400, .panel_height = 400, .view = {Vec3(0, 0, 1), Vec3(0, 1, 0)}};
  const auto image = drawn(style);
  ASSERT_EQ(image->GetDimensions()[0], 400);
  // Where the square lies, from what is coloured.
  int left = 400, right = 0, below = 400, above = 0;
  for (int y = 0; y < 365; ++y)
    for (int x = 0; x < 400; ++x)
      if (is_blue(*image, x, y) || is_cream(*image, x, y))
        left = std::min(left, x), right = std::max(right, x), below = std::min(below, y),
        above = std::max(above, y);
  EXPECT_GT(right - left, 300);
  int wrong = 0, right_ones = 0;
  for (int y = below + 3; y < above - 3; ++y)
    for (int x = left + 3; x < right - 3; ++x) {
      const double u = 3.0 * (x - left + 0.5) / (right - left + 1),
                   v = 2.0 * (y - below + 0.5) / (above - below + 1);
      const double width = 0.03;  // two pixels are left out at an edge of a cube
      if (std::abs(u - std::round(u)) < width || std::abs(v - std::round(v)) < width) continue;
      const bool odd = ((static_cast<int>(u) + static_cast<int>(v)) & 1) != 0;
      (odd ? is_blue(*image, x, y) : is_cream(*image, x, y)) ? ++right_ones : ++wrong;
    }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(right_ones, 80000);
}

TEST_F(Picture, EdgesLeaveTheCheckerAsItIs) {
  PictureStyle style{.panel_width = 400, .panel_height = 400, .view = {Vec3(0, 0, 1), Vec3(0, 1, 0)}};
  const auto without = drawn(style);
  style.edges = true;
  const auto with = drawn(style);
  int lines = 0, other_cubes = 0;
  for (int y = 0; y < 365; ++y)
    for (int x = 0; x < 400; ++x) {
      lines += (is_blue(*without, x, y) || is_cream(*without, x, y)) && !is_blue(*with, x, y) &&
               !is_cream(*with, x, y);
      other_cubes +=
          is_blue(*without, x, y) ? is_cream(*with, x, y) : is_cream(*without, x, y) && is_blue(*with, x, y);
    }
  EXPECT_GT(lines, 100) << "the diagonal";
  EXPECT_LT(lines, 4000);
  EXPECT_EQ(other_cubes, 0);
}

TEST_F(Picture, TheBarIsBelowAndMovesNothing) {
  PictureStyle style{.panel_width = 400, .panel_height = 400, .view = {Vec3(0, 0, 1), Vec3(0, 1, 0)}};
  const auto checker = drawn(style);
  style.colouring = colouring(*square(), "rest_position", {0, 4});
  const auto numbers = drawn(style);
  const int bar = numbers->GetDimensions()[1] - 400;
  EXPECT_GT(bar, 20);
  int differing = 0;
  for (int y = 0; y < 365; ++y)
    for (int x = 0; x < 400; ++x) {
      const auto is_surface = [&](vtkImageData& image, int row) {
        return is_blue(image, x, row) || is_cream(image, x, row) ||
               image.GetScalarComponentAsDouble(x, row, 0, 0) < 200;
      };
      differing += is_surface(*checker, y) != is_surface(*numbers, y + bar);
    }
  EXPECT_LT(differing, 1500) << "the rim's pixels at most";
}

// Of three corners with two names, two thirds of the triangle belong to one of them.
TEST(NameRegions, DivideTriangles) {
  TriangleMesh mesh =
      make_triangle_mesh({{0, 0, 0}, {6, 0, 0}, {0, 6, 0}, {6, 6, 0}}, {{0, 1, 2}, {1, 3, 2}});
  mesh.source = {4, 7, 7, 7};
  SurfaceState state;
  state.normal.assign(4, Vec3::UnitZ());
  state.motion.velocity.assign(4, Vec3::Zero());
  state.motion.confidence = state.mean_curvature = state.gaussian_curvature = {0, 0, 0, 0};
  const auto regions = name_regions(*surface_data({0, mesh, state}), "source");
  ASSERT_EQ(regions->GetNumberOfCells(), 4) << "three parts of the first, and the second";
  std::map<int, double> area;
  for (vtkIdType c = 0; c < 4; ++c) {
    vtkNew<vtkIdList> corners;
    regions->GetCellPoints(c, corners);
    Vec3 twice = Vec3::Zero();
    for (vtkIdType k = 0; k < corners->GetNumberOfIds(); ++k)
      twice += Vec3(regions->GetPoint(corners->GetId(k)))
                   .cross(Vec3(regions->GetPoint(corners->GetId((k + 1) % corners->GetNumberOfIds()))));
    EXPECT_GT(twice.z(), 0) << "oriented as before";
    area[static_cast<int>(regions->GetCellData()->GetArray("source")->GetTuple1(c))] += 0.5 * twice.z();
  }
  EXPECT_NEAR(area[4], 6, 1e-12);
  EXPECT_NEAR(area[7], 30, 1e-12);
}

TEST(Colouring, RangesAreRoundedAndNamesAreNot) {
  EXPECT_EQ(rounded({-5.07, 8.72}), (ValueRange{-10, 10}));
  EXPECT_EQ(rounded({0.013, 0.94}), (ValueRange{0, 1}));
  EXPECT_EQ(rounded({3, 3}), (ValueRange{3, 3}));
  EXPECT_EQ(colouring(*square(), "rest_position", {0, 4}).labels, 5);
  EXPECT_EQ(colouring(*square(), "rest_position", {0.1, 3.9}).labels, 2) << "its ends";
  EXPECT_FALSE(holds_names(*square(), "rest_position"));
  TriangleMesh mesh = make_triangle_mesh({{0, 0, 0}, {6, 0, 0}, {0, 6, 0}}, {{0, 1, 2}});
  mesh.source = {0, 3, 7};
  SurfaceState state;
  state.normal.assign(3, Vec3::UnitZ());
  state.motion.velocity.assign(3, Vec3::Zero());
  state.motion.confidence = state.mean_curvature = state.gaussian_curvature = {0, 0, 0};
  const auto names = surface_data({0, mesh, state});
  EXPECT_TRUE(holds_names(*names, "source"));
  EXPECT_NE(colouring(*names, "source", value_range(*names, "source")).table->GetIndexedLookup(), 0)
      << "eight";
}

TEST_F(Picture, SurfacesWithoutACheckerAreRefused) {
  vtkNew<vtkPolyData> nothing;
  const std::vector<Panel> panels{{"nothing", nothing.Get()}};
  EXPECT_THROW(draw_picture(folder / "a.png", panels, {}, std::nullopt, {}), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
