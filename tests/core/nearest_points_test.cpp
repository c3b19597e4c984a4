#include "core/nearest_points.h"

#include <gtest/gtest.h>

#include <random>

namespace kappaflow {
namespace {

std::uint32_t by_brute_force(std::span<const Vec3> points, const Vec3& x) {
  std::uint32_t nearest = 0;
  for (std::uint32_t i = 1; i < points.size(); ++i)
    if ((points[i] - x).squaredNorm() < (points[nearest] - x).squaredNorm()) nearest = i;
  return nearest;
}

TEST(NearestPoints, AreThoseThatBruteForceFinds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  const auto some = [&](int count) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = Vec3(coordinate(random), coordinate(random), coordinate(random));
    return points;
  };
  const auto points = some(1000), places = some(300);
  const std::vector<std::uint32_t> nearest = nearest_points(points, places);
  ASSERT_EQ(nearest.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(nearest[i], by_brute_force(points, places[i]));
}

TEST(NearestPoints, AreTheFirstIfSeveralAreAsNear) {
  std::vector<Vec3> points;
  for (int i = 0; i < 6 * 6 * 6; ++i) points.emplace_back(i % 6, i / 6 % 6, i / 36);
  points.insert(points.end(), points.begin(), points.end());
  std::shuffle(points.begin(), points.end(), std::mt19937(2));
  std::vector<Vec3> places = points;                                         // two are as near
  for (const Vec3& x : points) places.push_back(x + Vec3(0.5, 0, 0));        // four
  for (const Vec3& x : points) places.push_back(x + Vec3(0.5, 0.5, 0.5));    // sixteen
  for (const Vec3& x : points) places.push_back(x + Vec3(100, 50.5, -0.5));  // outside
  const std::vector<std::uint32_t> nearest = nearest_points(points, places);
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(nearest[i], by_brute_force(points, places[i]));
}

TEST(NearestPoints, DistancesToNeighboursAreThoseOfBruteForce) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<Vec3> points(200);
  for (Vec3& p : points) p = Vec3(coordinate(random), coordinate(random), coordinate(random));
  points.push_back(points[17]);  // at no distance from another
  const std::vector<double> squares = nearest_neighbour_squares(points);
  ASSERT_EQ(squares.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double least = kInfinity;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) least = std::min(least, (points[j] - points[i]).squaredNorm());
    EXPECT_DOUBLE_EQ(squares[i], least);
  }
}

TEST(NearestPoints, OfOneAndForNone) {
  const std::vector<Vec3> one{Vec3(1, 2, 3)};
  EXPECT_EQ(nearest_points(one, std::vector{Vec3(1e9, 0, 0)}), std::vector<std::uint32_t>{0});
  EXPECT_TRUE(nearest_points(one, {}).empty());
}

}  // namespace
}  // namespace kappaflow
