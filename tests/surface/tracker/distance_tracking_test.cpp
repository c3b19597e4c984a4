// Surfaces that are given as images of their distance, or as meshes, and tracked.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/mesh/ellipsoid_distance.h"
#include "tests/surface/tracker/tracked_images.h"

namespace kappaflow {
namespace {

using testing::by;
using testing::material_error;
using testing::tracked;

// An ellipsoid that turns by a quarter, seen by its distance alone.
TEST(DistanceTracking, FollowsATurningBody) {
  const Vec3 semi_axes(1, 0.75, 0.6), axis = Vec3(1, 2, 2) / 3;
  const double turn = std::numbers::pi / 2;
  const int frames = 13;
  const auto image = [&](int k) {
    const double t = static_cast<double>(k) / (frames - 1);
    const Mat3 R = testing::rotation(turn * t * axis);
    return std::make_shared<DistanceImage>(
        testing::image_of(
            [&](const Vec3& x) { return testing::ellipsoid_distance(semi_axes, R.transpose() * x); }, 1.3,
            0.06),
        t);
  };
  const std::vector<std::string> methods{"normal", "total", "curvature", "regional"};
  const FieldSurfaces surfaces = tracked(frames, image, by(methods));
  const Mat3 R = testing::rotation(turn * axis);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const TriangleMesh& mesh = surfaces.mesh(m);
    const double volume = area_and_volume(mesh.position, mesh.triangles).volume;
    EXPECT_NEAR(volume / (4.0 / 3 * std::numbers::pi * semi_axes.prod()), 1, 0.004) << methods[m];
    const double error = material_error(mesh, [&](const Vec3& x) -> Vec3 { return R * x; });
    if (methods[m] == "regional")
      EXPECT_LT(error, 0.02);
    else
      EXPECT_GT(error, 0.3) << methods[m] << " does not turn with a body as round as this";
  }
}

}  // namespace
}  // namespace kappaflow
