#include "surface/mesh/nearest_on_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/nearest_on_triangle.h"
#include "surface/mesh/isosurface.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/tracker/moving_ellipsoid.h"

namespace kappaflow {
namespace {

// Against all triangles, one by one.
TEST(NearestOnMesh, IsTheNearestPointOfAnyTriangle) {
  const TriangleMesh mesh = extract_isosurface(*testing::moving_ellipsoid(0, 1).at(0), 0.2);
  const NearestOnMesh surface(mesh);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-1.5, 1.5);
  for (int k = 0; k < 200; ++k) {
    const Vec3 x(place(random), place(random), place(random));
    double nearest = kInfinity;
    for (const Triangle& t : mesh.triangles)
      nearest = std::min(
          nearest,
          (nearest_on_triangle({mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]}, x).point - x)
              .norm());
    const auto point = surface.nearest(x).value();
    EXPECT_NEAR(point.distance, nearest, 1e-12);
    EXPECT_NEAR((blended(mesh.position, point.blend) - x).norm(), nearest, 1e-12);
    for (const double weight : point.blend.weight) EXPECT_GE(weight, -1e-9);
  }
  EXPECT_FALSE(NearestOnMesh(TriangleMesh()).nearest(Vec3::Zero()).has_value());
}

}  // namespace
}  // namespace kappaflow
