// The tree against a search through all triangles.
#include "core/triangle_tree.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace kappaflow {
namespace {

TEST(TriangleTree, FindsTheNearestOfAll) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-1, 1);
  const auto point = [&](double scale) -> Vec3 {
    return scale * Vec3(along(random), along(random), along(random));
  };
  for (const int count : {1, 4, 5, 300}) {
    std::vector<TriangleTree::Corners> triangles;
    for (int t = 0; t < count; ++t) {
      const Vec3 at = point(2);
      triangles.push_back({at + point(0.3), at + point(0.3), at + point(0.3)});
    }
    const TriangleTree tree(triangles);
    for (int n = 0; n < 200; ++n) {
      const Vec3 x = point(3);
      double least = std::numeric_limits<double>::infinity();
      std::uint32_t nearest = 0;
      for (std::uint32_t t = 0; t < triangles.size(); ++t)
        if (const double square = (nearest_on_triangle(triangles[t], x).point - x).squaredNorm();
            square < least) {
          least = square;
          nearest = t;
        }
      const TriangleTree::Nearest found = tree.nearest(x);
      EXPECT_EQ(found.triangle, nearest);
      EXPECT_EQ(found.square, least);
      EXPECT_EQ(found.at.point, nearest_on_triangle(triangles[nearest], x).point);
    }
  }
}

}  // namespace
}  // namespace kappaflow
