#include "scenes/wall_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <random>

#include "scenes/shapes.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : engine_(seed) {}
  Vec3 in(const Vec3& lower, const Vec3& upper) {
    std::uniform_real_distribution<double> share(0, 1);
    const double x = share(engine_), y = share(engine_), z = share(engine_);
    return lower + Vec3(x, y, z).cwiseProduct(upper - lower);
  }

 private:
  std::mt19937 engine_;
};

double segment_distance(const Vec3& x, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - t * (b - a)).norm();
}

/// The distance to the plane where the foot is inside the triangle, else to the nearest edge.
double triangle_distance(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a).normalized();
  const Vec3 foot = x - n.dot(x - a) * n;
  const bool inside = (b - a).cross(foot - a).dot(n) >= 0 && (c - b).cross(foot - b).dot(n) >= 0 &&
                      (a - c).cross(foot - c).dot(n) >= 0;
  if (inside) return std::abs(n.dot(x - a));
  return std::min({segment_distance(x, a, b), segment_distance(x, b, c), segment_distance(x, c, a)});
}

/// The oracle: all triangles for the distance, and the winding number for the side (van Oosterom & Strackee
/// 1983).
double brute_force_depth(const TriangleSurface& surface, const Vec3& x) {
  double least = std::numeric_limits<double>::infinity(), solid_angle = 0;
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 a = surface.vertices[i] - x, b = surface.vertices[j] - x, c = surface.vertices[k] - x;
    least = std::min(least, triangle_distance(Vec3::Zero(), a, b, c));
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    solid_angle +=
        2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(solid_angle) > 2 * M_PI ? least : -least;
}

/// An octahedron subdivided three times, each vertex pushed to a random distance: spikes and pits of every
/// sharpness.
TriangleSurface spiky_ball(unsigned seed) {
  TriangleSurface ball{
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < 3; ++level) {
    std::vector<Triangle> finer;
    std::map<std::pair<int, int>, int> middle;
    const auto middle_of = [&](int a, int b) {
      const auto [entry, is_new] =
          middle.try_emplace(std::minmax({a, b}), static_cast<int>(ball.vertices.size()));
      if (is_new) ball.vertices.push_back((ball.vertices[a] + ball.vertices[b]).normalized());
      return entry->second;
    };
    for (const auto& [a, b, c] : ball.triangles) {
      const int ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    ball.triangles = finer;
  }
  RandomPoints random(seed);
  for (Vec3& x : ball.vertices) x *= random.in(Vec3(0.3, 0, 0), Vec3(1.5, 1, 1)).x();
  return ball;
}

void expect_agrees_with_brute_force(const TriangleSurface& surface, const Vec3& lower, const Vec3& upper,
                                    int count) {
  const WallDistance walls(solid_walls(std::vector{surface}));
  RandomPoints random(3);
  int inside = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3 x = random.in(lower, upper);
    const double expected = brute_force_depth(surface, x);
    ASSERT_NEAR(walls.depth(x), expected, 1e-12) << x.transpose();
    inside += expected > 0;
  }
  EXPECT_GT(inside, count / 20);
  EXPECT_LT(inside, count - count / 20);
}

TEST(WallDistance, AgreesWithBruteForceOnStairs) {
  const TriangleSurface stairs = stairs_surface(
      {.steps = 5, .rise = 0.2, .run = 0.5, .landing = 1.5, .floor = 2, .width = 1.6, .thickness = 0.2});
  expect_agrees_with_brute_force(stairs, Vec3(-4, -0.5, -1.2), Vec3(2.5, 1.5, 1.2), 20000);
}

TEST(WallDistance, AgreesWithBruteForceOnSpikesAndPits) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const TriangleSurface ball = spiky_ball(seed);
    ASSERT_EQ(mesh_topology(ball.vertices, ball.triangles).genus, 0);
    expect_agrees_with_brute_force(ball, Vec3::Constant(-1.2), Vec3::Constant(1.2), 3000);
  }
}

TEST(WallDistance, AgreesWithBruteForceNextToVerticesAndEdges) {
  const TriangleSurface ball = spiky_ball(4);
  const WallDistance walls(solid_walls(std::vector{ball}));
  RandomPoints random(5);
  for (const Triangle& t : ball.triangles) {
    const Vec3 &a = ball.vertices[t[0]], &b = ball.vertices[t[1]];
    for (const double size : {1e-2, 1e-5, 1e-8}) {
      const Vec3 offset = random.in(Vec3::Constant(-size), Vec3::Constant(size));
      for (const Vec3& x : {Vec3(a + offset), Vec3(0.5 * (a + b) + offset)})
        ASSERT_NEAR(walls.depth(x), brute_force_depth(ball, x), 1e-14) << x.transpose();
    }
  }
}

/// Depth in a box of half edges h about the origin: exact.
double box_depth(const Vec3& h, const Vec3& x) {
  const Vec3 outside = x.cwiseAbs() - h;
  return outside.maxCoeff() < 0 ? -outside.maxCoeff() : -outside.cwiseMax(0).norm();
}

TEST(WallDistance, IsExactAroundABox) {
  const Vec3 h(1, 0.25, 3);
  const WallDistance walls(solid_walls(std::vector{box_surface({-h, h})}));
  RandomPoints random(6);
  for (int i = 0; i < 20000; ++i) {
    const Vec3 x = random.in(-2 * h, 2 * h);
    ASSERT_NEAR(walls.depth(x), box_depth(h, x), 1e-14) << x.transpose();
  }
  // Regular points: planes of symmetry, edges, corners and points of the surface itself.
  for (int i = 0; i < 9 * 9 * 9; ++i) {
    const Vec3 x = (Vec3(i % 9, i / 9 % 9, i / 81) / 4 - Vec3::Ones()).cwiseProduct(2 * h);
    ASSERT_NEAR(walls.depth(x), box_depth(h, x), 1e-14) << x.transpose();
  }
}

TEST(WallDistance, OfSeveralWallsIsTheDeepest) {
  const Vec3 h(1, 1, 1), shift(3, 0, 0);
  const WallDistance walls(
      solid_walls(std::vector{box_surface({-h, h}), box_surface({shift - h, shift + h})}));
  EXPECT_NEAR(walls.depth(Vec3(0.5, 0, 0)), 0.5, 1e-15);
  EXPECT_NEAR(walls.depth(Vec3(2.25, 0, 0)), 0.25, 1e-15);
  EXPECT_NEAR(walls.depth(Vec3(1.75, 0, 0)), -0.25, 1e-15);
}

TEST(WallDistance, WithoutWallsNothingIsInside) {
  EXPECT_EQ(WallDistance({}).depth(Vec3::Zero()), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace kappaflow
