#include "surface/measure/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace kappaflow {
namespace {

bool is_blue(const Rgb& c) {
  return c[2] > c[0];
}

TEST(Checker, FollowsTheParityOfTheCube) {
  std::vector<Vec3> at;
  for (int i = -3; i < 3; ++i)
    for (int j = -3; j < 3; ++j)
      for (int k = -3; k < 3; ++k) at.emplace_back(0.5 * Vec3(i + 0.3, j + 0.6, k + 0.9));
  const std::vector<Rgb> colours = checker_colours(at, {.edge = 0.5});
  for (std::size_t v = 0; v < at.size(); ++v) {
    const Vec3 cube = (at[v] / 0.5).array().floor();
    EXPECT_EQ(is_blue(colours[v]), (static_cast<int>(cube.sum()) & 1) != 0);
  }
}

TEST(Checker, OneCubeHasOneColourAndCubesDiffer) {
  std::vector<Vec3> at;
  for (int i = 0; i < 20; ++i) at.emplace_back(2 * i + 0.25, 0.5, 0.5);
  const std::vector<Rgb> colours = checker_colours(at, {.edge = 1.0});
  std::vector<Vec3> moved = at;
  for (Vec3& x : moved) x += Vec3(0.5, 0.4, -0.4);
  EXPECT_EQ(checker_colours(moved, {.edge = 1.0}), colours);
  EXPECT_GT(std::set<Rgb>(colours.begin(), colours.end()).size(), 10u) << "brightness varies";
}

TEST(Checker, HasAColourAnywhere) {
  const std::vector<Vec3> at{{1e300, -1e300, 0}, {HUGE_VAL, 0, 0}, {std::nan(""), 0, 0}};
  EXPECT_EQ(checker_colours(at, {.edge = 1e-3}).size(), 3u);
}

TEST(Checker, StartsAtItsOrigin) {
  const std::vector<Vec3> at{{0.3, -0.2, 0.7}, {2.3, 4.4, -1.2}, {-3.9, 0.1, 0.6}};
  std::vector<Vec3> moved = at;
  const Vec3 origin(0.25, -7, 3.5);
  for (Vec3& x : moved) x += origin;
  EXPECT_EQ(checker_colours(moved, {origin, 0.75}), checker_colours(at, {.edge = 0.75}));
}

/// The distance of x from the nearest plane of the checker [edges].
double distance_to_plane(const Checker& checker, int axis, double x) {
  const double cubes = (x - checker.origin[axis]) / checker.edge;
  return std::abs(cubes - std::round(cubes));
}

TEST(Checker, HasNoPlaneInTheFacesOfABox) {
  // Corners of a box's faces, with their normals: both faces of an axis can be a quarter of an edge away.
  for (const double edge : {0.1, 0.13, 0.25, 0.6, 2.0}) {
    const Vec3 lower(-0.5, 0.2, 1), upper(0.5, 0.9, 1.3);
    std::vector<Vec3> position, normal;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true})
        for (const double share : {0.0, 0.3, 1.0}) {
          Vec3 x = lower + share * (upper - lower);
          x[axis] = high ? upper[axis] : lower[axis];
          position.push_back(x);
          normal.push_back(high ? Vec3::Unit(axis) : Vec3(-Vec3::Unit(axis)));
        }
    const Checker checker = checker_beside(position, normal, edge);
    EXPECT_EQ(checker.edge, edge);
    for (int axis = 0; axis < 3; ++axis)
      for (const double x : {lower[axis], upper[axis]})
        EXPECT_GT(distance_to_plane(checker, axis, x), 0.2) << edge << " " << axis;
  }
}

TEST(TextureCoordinates, PlanarSpansTheBox) {
  const std::vector<Vec3> at{{-1, 2, 0}, {3, 4, 1}, {1, 3, 5}};
  const auto uv = texture_coordinates(at, bounding_box(at), TextureProjection::planar);
  EXPECT_EQ(uv[0], Vec2(0, 0));
  EXPECT_EQ(uv[1], Vec2(1, 1));
  EXPECT_EQ(uv[2], Vec2(0.5, 0.5));
}

TEST(TextureCoordinates, SphericalIsLongitudeAndLatitude) {
  const std::vector<Vec3> at{{1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, 0, -1}};
  const auto uv = texture_coordinates(at, bounding_box(at), TextureProjection::spherical);
  EXPECT_NEAR((uv[0] - Vec2(0.5, 0.5)).norm(), 0, 1e-15);
  EXPECT_NEAR(uv[1][1], 1, 1e-15);
  EXPECT_NEAR(uv[2][1], 0, 1e-15);
  EXPECT_NEAR((uv[3] - Vec2(0.75, 0.5)).norm(), 0, 1e-15);
  EXPECT_NEAR((uv[5] - Vec2(0.25, 0.5)).norm(), 0, 1e-15);
}

TEST(TextureCoordinates, BoxUsesTheNearestFace) {
  // The corners make the box [-1, 1] x [-2, 2] x [-3, 3]; the other points lie on its faces.
  const std::vector<Vec3> at{{-1, -2, -3}, {1, 2, 3}, {1, 1, 0}, {0.5, 2, -1.5}, {0, -1, 3}};
  const auto uv = texture_coordinates(at, bounding_box(at), TextureProjection::box);
  EXPECT_NEAR((uv[2] - Vec2(0.5, 0.75)).norm(), 0, 1e-15);   // +x face: (z, y)
  EXPECT_NEAR((uv[3] - Vec2(0.75, 0.25)).norm(), 0, 1e-15);  // +y face: (x, z)
  EXPECT_NEAR((uv[4] - Vec2(0.5, 0.25)).norm(), 0, 1e-15);   // +z face: (x, y)
}

/// Points of a sphere about the middle of its bounding box, and triangles between them across all seams.
struct TexturedSphere {
  TexturedSphere() {
    constexpr int kRings = 12, kPoints = 24;
    for (int i = 1; i < kRings; ++i)
      for (int j = 0; j < kPoints; ++j) {
        const double polar = std::numbers::pi * i / kRings, turn = 2 * std::numbers::pi * (j + 0.3) / kPoints;
        position.emplace_back(std::sin(polar) * std::cos(turn), std::cos(polar),
                              std::sin(polar) * std::sin(turn));
      }
    for (int i = 0; i + 2 < kRings; ++i)
      for (int j = 0; j < kPoints; ++j) {
        const int a = i * kPoints + j, b = i * kPoints + (j + 1) % kPoints;
        triangles.push_back({a, b, a + kPoints});
        triangles.push_back({b, b + kPoints, a + kPoints});
      }
  }
  std::vector<Vec3> position;
  std::vector<Triangle> triangles;
};

/// How far apart the coordinates of a triangle's corners are.
double widest(std::span<const Vec2> value, std::span<const Triangle> corners) {
  double most = 0;
  for (const Triangle& t : corners)
    for (int c = 0; c < 3; ++c)
      most = std::max(most, (value[t[c]] - value[t[(c + 1) % 3]]).lpNorm<Eigen::Infinity>());
  return most;
}

TEST(SeamlessTextureCoordinates, NoTriangleSpansASeam) {
  const TexturedSphere sphere;
  const Bounds box = bounding_box(sphere.position);
  for (const auto projection : {TextureProjection::spherical, TextureProjection::box}) {
    const auto plain = texture_coordinates(sphere.position, box, projection);
    const SeamlessTexture texture = seamless_texture(sphere.position, sphere.triangles, box, projection);
    EXPECT_GT(widest(plain, sphere.triangles), 0.6) << "nothing was tested";
    EXPECT_LT(widest(texture.value, texture.corners), 0.25);
    ASSERT_EQ(texture.corners.size(), sphere.triangles.size());
    ASSERT_GT(texture.value.size(), plain.size());
    EXPECT_LT(texture.value.size(), plain.size() * 3 / 2) << "one more at seams only";
    for (std::size_t v = 0; v < plain.size(); ++v) EXPECT_EQ(texture.value[v], plain[v]);
  }
  const SeamlessTexture planar =
      seamless_texture(sphere.position, sphere.triangles, box, TextureProjection::planar);
  EXPECT_EQ(planar.corners, sphere.triangles);
  EXPECT_EQ(planar.value.size(), sphere.position.size());
}

// A longitude may be a turn more; on the box a corner has one of the projections along an axis.
TEST(SeamlessTextureCoordinates, CornersHaveTheirVerticesCoordinates) {
  const TexturedSphere sphere;
  const Bounds box = bounding_box(sphere.position);
  const Vec3 size = box.upper - box.lower;
  const auto longitude = texture_coordinates(sphere.position, box, TextureProjection::spherical);
  const auto spherical =
      seamless_texture(sphere.position, sphere.triangles, box, TextureProjection::spherical);
  const auto boxed = seamless_texture(sphere.position, sphere.triangles, box, TextureProjection::box);
  for (std::size_t t = 0; t < sphere.triangles.size(); ++t)
    for (int c = 0; c < 3; ++c) {
      const int v = sphere.triangles[t][c];
      const Vec2 turns = spherical.value[spherical.corners[t][c]] - longitude[v];
      EXPECT_TRUE(turns == Vec2(0, 0) || (turns - Vec2(1, 0)).norm() < 1e-15);
      const Vec3 s = (sphere.position[v] - box.lower).cwiseQuotient(size);
      const Vec2 found = boxed.value[boxed.corners[t][c]];
      double nearest = 1;
      for (const Vec2& on_face : {Vec2(s.z(), s.y()), Vec2(s.x(), s.z()), Vec2(s.x(), s.y())})
        nearest = std::min(nearest, (found - on_face).norm());
      EXPECT_LT(nearest, 1e-12);
    }
}

TEST(TextureCoordinates, FlatAndEmptyInputsAreFinite) {
  EXPECT_TRUE(texture_coordinates({}, Bounds{}, TextureProjection::box).empty());
  const std::vector<Vec3> point{{1, 2, 3}};
  for (const auto p : {TextureProjection::planar, TextureProjection::spherical, TextureProjection::box})
    EXPECT_EQ(texture_coordinates(point, bounding_box(point), p)[0], Vec2(0.5, 0.5));
}

}  // namespace
}  // namespace kappaflow
