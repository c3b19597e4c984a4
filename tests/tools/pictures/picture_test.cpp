#include "tools/pictures/picture.h"

#include <gtest/gtest.h>
#include <vtkCellData.h>
#include <vtkImageData.h>
#include <vtkImageWriter.h>
#include <vtkJPEGWriter.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>
#include <vtkPNGWriter.h>
#include <vtkPointData.h>

#include <Eigen/Geometry>
#include <array>
#include <map>

#include "core/errors.h"
#include "surface/measure/texture.h"
#include "tests/tools/image.h"
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

/// Where the square lies in its picture: from what is coloured, and no title.
struct Place {
  int left = 400, right = 0, below = 400, above = 0;
};

bool is_blue(vtkImageData& image, int x, int y) {
  return image.GetScalarComponentAsDouble(x, y, 0, 2) > image.GetScalarComponentAsDouble(x, y, 0, 0) + 20;
}
bool is_cream(vtkImageData& image, int x, int y) {
  return image.GetScalarComponentAsDouble(x, y, 0, 0) > image.GetScalarComponentAsDouble(x, y, 0, 2) + 20;
}

Place place_of(vtkImageData& image) {
  Place place;
  for (int y = 0; y < 365; ++y)
    for (int x = 0; x < 400; ++x)
      if (is_blue(image, x, y) || is_cream(image, x, y))
        place = {std::min(place.left, x), std::max(place.right, x), std::min(place.below, y),
                 std::max(place.above, y)};
  return place;
}

/// Calls check(x, y, u, v) for each pixel of the square but for its rim; u, v: its rest position in cubes.
template <class Check>
void for_each_pixel(const Place& place, const Check& check) {
  for (int y = place.below + 3; y < place.above - 3; ++y)
    for (int x = place.left + 3; x < place.right - 3; ++x)
      check(x, y, 3.0 * (x - place.left + 0.5) / (place.right - place.left + 1),
            2.0 * (y - place.below + 0.5) / (place.above - place.below + 1));
}

constexpr double kTwoPixels = 0.03;  // in cubes

bool is_near_whole(double x) {
  return std::abs(x - std::round(x)) < kTwoPixels;
}

const PictureStyle kFromAbove{
    .panel_width = 400, .panel_height = 400, .view = {Vec3(0, 0, 1), Vec3(0, 1, 0)}};

// Six cubes on two triangles: no vertex colours could tell them apart.
TEST_F(Picture, CheckerIsEvaluatedForEveryPixel) {
  const auto image = drawn(kFromAbove);
  ASSERT_EQ(image->GetDimensions()[0], 400);
  const Place place = place_of(*image);
  EXPECT_GT(place.right - place.left, 300);
  int wrong = 0, right_ones = 0;
  for_each_pixel(place, [&](int x, int y, double u, double v) {
    if (is_near_whole(u) || is_near_whole(v)) return;
    const bool odd = ((static_cast<int>(u) + static_cast<int>(v)) & 1) != 0;
    (odd ? is_blue(*image, x, y) : is_cream(*image, x, y)) ? ++right_ones : ++wrong;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(right_ones, 80000);
}

TEST_F(Picture, StripesLieAcrossTheDiagonal) {
  PictureStyle style = kFromAbove;
  style.texture.kind = SolidTexture::Kind::stripes;
  const auto image = drawn(style);
  int wrong = 0, right_ones = 0;
  for_each_pixel(place_of(*image), [&](int x, int y, double u, double v) {
    const double s = 2 * (u + v + 0.5);
    if (std::abs(s - std::round(s)) < 4 * kTwoPixels) return;
    (static_cast<int>(s) % 2 == 1 ? is_blue(*image, x, y) : is_cream(*image, x, y)) ? ++right_ones : ++wrong;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(right_ones, 60000);
}

TEST_F(Picture, TheGridIsLinesBetweenTheCubes) {
  PictureStyle style = kFromAbove;
  style.texture.kind = SolidTexture::Kind::grid;
  const auto image = drawn(style);
  int wrong = 0, lines = 0, between = 0;
  for_each_pixel(place_of(*image), [&](int x, int y, double u, double v) {
    const double away = std::min(std::abs(u - std::round(u)), std::abs(v - std::round(v)));
    if (std::abs(away - 0.04) < kTwoPixels) return;
    if (away < 0.04) is_blue(*image, x, y) ? ++lines : ++wrong;
    if (away > 0.04) is_cream(*image, x, y) ? ++between : ++wrong;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(lines, 1000);
  EXPECT_GT(between, 80000);
}

/// An image of four parts: red and green below, blue and yellow above.
std::filesystem::path four_colours(const std::filesystem::path& file) {
  vtkNew<vtkImageData> image;
  image->SetDimensions(64, 32, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool right = x >= 32, above = y >= 16;
      image->SetScalarComponentFromDouble(x, y, 0, 0, right == above ? 230 : 20);
      image->SetScalarComponentFromDouble(x, y, 0, 1, right ? 230 : 20);
      image->SetScalarComponentFromDouble(x, y, 0, 2, above && !right ? 230 : 20);
    }
  vtkSmartPointer<vtkImageWriter> writer = vtkSmartPointer<vtkPNGWriter>::New();
  if (file.extension() == ".jpg") writer = vtkSmartPointer<vtkJPEGWriter>::New();
  writer->SetInputData(image);
  writer->SetFileName(file.c_str());
  writer->Write();
  return file;
}

/// Red, green and blue of a pixel, each whether it is more than half of the largest.
std::array<bool, 3> hue(vtkImageData& image, int x, int y) {
  std::array<double, 3> c{};
  for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = image.GetScalarComponentAsDouble(x, y, 0, k);
  const double most = std::max({c[0], c[1], c[2]});
  return {c[0] > most / 2, c[1] > most / 2, c[2] > most / 2};
}

// What a pixel shows is what the image has at texture_coordinates() of the pixel's rest position.
TEST_F(Picture, ImagesLieAtTheTextureCoordinates) {
  const Place place = place_of(*drawn(kFromAbove));
  PictureStyle style = kFromAbove;
  const Bounds box{Vec3(-1, -0.5, -1), Vec3(4, 2.5, 1.4)};
  for (const char* name : {"four.png", "four.jpg"})
    for (const auto projection :
         {TextureProjection::planar, TextureProjection::spherical, TextureProjection::box}) {
      style.texture = solid_texture(four_colours(folder / name).string(), box, projection);
      const auto image = drawn(style);
      std::map<std::array<bool, 3>, int> seen;
      int wrong = 0;
      for_each_pixel(place, [&](int x, int y, double u, double v) {
        const Vec3 rest(u, v, 0.5);
        const Vec2 at = texture_coordinates(std::span(&rest, 1), box, projection)[0];
        if ((at - Vec2(0.5, 0.5)).cwiseAbs().minCoeff() < 0.08) return;  // beside the parts' edges
        const Vec3 r = (2 * rest - box.lower - box.upper).cwiseQuotient(box.upper - box.lower).cwiseAbs();
        if (projection == TextureProjection::box && std::abs(r.x() - r.y()) < 0.04) return;
        if (projection == TextureProjection::box && std::abs(r.z() - std::max(r.x(), r.y())) < 0.04) return;
        const bool right = at.x() > 0.5, above = at.y() > 0.5;
        const std::array<bool, 3> expected{right == above, right, above && !right}, found = hue(*image, x, y);
        ++seen[found];
        wrong += found != expected;
      });
      EXPECT_EQ(wrong, 0) << name << " " << static_cast<int>(projection);
      EXPECT_GE(seen.size(), 2u);
    }
}

TEST_F(Picture, FilesThatAreNoImagesAreOneLine) {
  const auto message = [&](const char* name) {
    return message_of<IoError>([&] { solid_texture((folder / name).string(), {}, TextureProjection::box); });
  };
  testing::internal::CaptureStderr();
  file("a.png", "no picture");
  file("a.jpg", "no picture");
  file("b.png", "\x89PNG\r\n\x1a\nbroken");
  file("b.jpg", "\xff\xd8\xff\xe0 broken");
  const std::string whole = bytes_of(four_colours(folder / "whole.png"));
  EXPECT_NE(solid_texture((folder / "whole.png").string(), {}, TextureProjection::box).image, nullptr);
  for (const std::size_t at : {20UL, whole.size() / 2, whole.size() - 20}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    file("c.png", damaged);
    EXPECT_EQ(message("c.png"), (folder / "c.png").string() + ": is not a picture in PNG") << at;
    file("c.png", whole.substr(0, at));
    EXPECT_EQ(message("c.png"), (folder / "c.png").string() + ": is not a picture in PNG") << at;
  }
  EXPECT_EQ(message("a.png"), (folder / "a.png").string() + ": is not a picture in PNG");
  EXPECT_EQ(message("a.jpg"), (folder / "a.jpg").string() + ": is not a picture in JPEG");
  EXPECT_EQ(message("b.png"), (folder / "b.png").string() + ": is not a picture in PNG");
  EXPECT_EQ(message("b.jpg"), (folder / "b.jpg").string() + ": is not a picture in JPEG");
  EXPECT_EQ(message("none.png"),
            (folder / "none.png").string() + ": cannot be read (No such file or directory)");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "VTK prints nothing of its own";
  EXPECT_TRUE(is_texture("a.jpeg"));
  EXPECT_FALSE(is_texture("velocity"));
}

// The square is flat: what its light changes by is its vertices' normals.
TEST_F(Picture, LightFollowsTheNormals) {
  const auto tilted = square();
  vtkDataArray& normals = *tilted->GetPointData()->GetNormals();
  for (const int vertex : {0, 1}) normals.SetTuple3(vertex, 0, -0.8, 0.6);
  for (const int vertex : {2, 3}) normals.SetTuple3(vertex, 0, 0.6, 0.8);
  const std::vector<Panel> panels{{"square", tilted}};
  PictureStyle style = kFromAbove;
  style.colouring = colouring(*tilted, "confidence", {0, 1});
  draw_picture(folder / "a.png", panels, {}, std::nullopt, style);
  const Image image(folder / "a.png");
  std::vector<int> along;
  for (int y = 80; y <= 360; y += 40) along.push_back(image.at(200, y, 0));
  EXPECT_TRUE(std::ranges::is_sorted(along)) << "smoothly, ever lighter";
  EXPECT_GT(along.back(), along.front() + 40) << "the key light comes from above";
}

TEST_F(Picture, EdgesLeaveTheCheckerAsItIs) {
  PictureStyle style = kFromAbove;
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
  PictureStyle style = kFromAbove;
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
