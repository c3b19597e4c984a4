#include "surface/measure/texture_jumps.h"

#include <gtest/gtest.h>

#include "surface/mesh/isosurface.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

/// A sphere whose rest positions are map(position).
template <class Map>
TextureJumps jumps_of(double spacing, const Map& map) {
  const testing::EllipsoidField sphere(Vec3::Zero(), Mat3::Identity(), Vec3::Ones());
  TriangleMesh mesh = extract_isosurface(sphere, spacing);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) mesh.rest_position[v] = map(mesh.position[v]);
  return texture_jumps(mesh);
}

TEST(TextureJumps, VanishWithTheMeshWidthWhereTheMapIsSmooth) {
  const auto smooth = [](const Vec3& x) {
    return Vec3(x[0] + 0.3 * x[1] * x[2], 2 * x[1], x[2] - 0.2 * x[0]);
  };
  const TextureJumps coarse = jumps_of(0.2, smooth), fine = jumps_of(0.05, smooth);
  EXPECT_LT(fine.mean, 0.4 * coarse.mean);  // of first order: a quarter
  EXPECT_EQ(fine.cracks, 0);
}

TEST(TextureJumps, SeeATear) {
  // The right half of the map is slid along the tear by a quarter of the radius.
  const auto torn = [](const Vec3& x) { return Vec3(x[0], x[1] + (x[0] > 0.013 ? 0.25 : 0), x[2]); };
  EXPECT_GT(jumps_of(0.05, torn).cracks, 0.005);
  const auto nowhere = [](const Vec3&) { return Vec3(1, 2, 3); };
  EXPECT_EQ(jumps_of(0.2, nowhere).mean, 0) << "a map without a gradient has no relative jump";
}

}  // namespace
}  // namespace kappaflow
