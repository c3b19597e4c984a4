#include "surface/mesh/self_intersection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/triangle_crossing.h"
#include "surface/mesh/block_isosurface.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;

TEST(SelfIntersection, CountsThePairsThatABruteForceSearchFinds) {
  // Two bodies that overlap, and one far away: pieces of one mesh. Askew, so that nothing merely touches.
  TriangleMesh mesh;
  for (const Vec3& centre : {Vec3(0, 0, 0), Vec3(0.7, 0.2, 0.1), Vec3(5, 0, 0)}) {
    const Mat3 askew = testing::rotation(Vec3(0.3, 0.5, -1));
    const TriangleMesh one = extract_isosurface(EllipsoidField(centre, askew, Vec3(1, 0.9, 0.8)), 0.31);
    const int first = static_cast<int>(mesh.position.size());
    mesh.position.insert(mesh.position.end(), one.position.begin(), one.position.end());
    for (const Triangle& t : one.triangles)
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  const auto volume = [&](int a, int b, int c, int d) {
    const Vec3 x = mesh.position[a];
    return (mesh.position[b] - x).cross(mesh.position[c] - x).dot(mesh.position[d] - x);
  };
  const auto pierces = [&](int p, int q, const Triangle& t) {
    const bool a = volume(p, q, t[0], t[1]) > 0, b = volume(p, q, t[1], t[2]) > 0,
               c = volume(p, q, t[2], t[0]) > 0;
    return a == b && b == c && volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) < 0;
  };
  const auto cuts = [&](const Triangle& s, const Triangle& t) {
    return pierces(s[0], s[1], t) || pierces(s[1], s[2], t) || pierces(s[2], s[0], t);
  };
  std::size_t pairs = 0;
  for (std::size_t a = 0; a < mesh.triangles.size(); ++a)
    for (std::size_t b = a + 1; b < mesh.triangles.size(); ++b) {
      const Triangle &s = mesh.triangles[a], &t = mesh.triangles[b];
      const bool share = std::ranges::any_of(s, [&](int v) { return std::ranges::find(t, v) != t.end(); });
      pairs += !share && (cuts(s, t) || cuts(t, s));
    }
  EXPECT_GT(pairs, 20u);
  EXPECT_EQ(self_intersections(mesh.position, mesh.triangles), pairs);
}

TEST(SelfIntersection, NoneInAnIsosurfaceAndSomeWhereAVertexIsPulledThrough) {
  TriangleMesh mesh = extract_isosurface(EllipsoidField(Vec3::Zero(), Mat3::Identity(), Vec3::Ones()), 0.2);
  EXPECT_EQ(self_intersections(mesh.position, mesh.triangles), 0u);
  mesh.position[0] *= -1.5;
  EXPECT_GT(self_intersections(mesh.position, mesh.triangles), 0u);
  EXPECT_EQ(self_intersections({}, {}), 0u);
  EXPECT_EQ(self_intersections(std::vector<Vec3>(3, Vec3(1, 2, 3)), std::vector<Triangle>(2, {0, 1, 2})), 0u)
      << "all in one point";
}

// Triangles at random, some of them large, against all pairs; one far away changes nothing.
TEST(SelfIntersection, FindsWhatBruteForceFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double far : {1.0, 1e30, 1e200}) {
    std::vector<Vec3> position;
    std::vector<Triangle> triangles;
    for (int t = 0; t < 700; ++t) {
      const double size = t % 50 == 0 ? 0.7 : 0.1;
      const Vec3 middle(uniform(random), uniform(random), uniform(random));
      for (int c = 0; c < 3; ++c)
        position.push_back(middle + size * Vec3(uniform(random), uniform(random), uniform(random)));
      triangles.push_back({3 * t, 3 * t + 1, t % 3 == 0 && t > 0 ? 3 * t - 1 : 3 * t + 2});
    }
    std::fill_n(position.rbegin(), 3, Vec3::Constant(-far));
    triangles.back() = {2097, 2098, 2099};
    const std::size_t known = 400;
    std::vector<char> crosses(triangles.size(), 0);
    for (std::size_t a = 0; a < triangles.size(); ++a)
      for (std::size_t b = std::max(a + 1, known); b < triangles.size(); ++b)
        if (triangles_cross(position, triangles[a], triangles[b])) crosses[a] = crosses[b] = 1;
    std::vector<int> expected;
    for (std::size_t t = 0; t < crosses.size(); ++t)
      if (crosses[t]) expected.push_back(static_cast<int>(t));
    EXPECT_GT(expected.size(), 100u);
    EXPECT_EQ(intersecting_triangles(position, triangles, known), expected) << far;
  }
}

}  // namespace
}  // namespace kappaflow
