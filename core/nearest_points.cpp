#include "core/nearest_points.h"

#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/point_tree.h"

namespace kappaflow {
namespace {

constexpr double kRounding = 1 + 1e-12;  // of the tree's distances

/// As nanoflann wants what it finds. Its own takes the one that it meets first where several points are
/// nearest.
struct Nearest {
  using DistanceType = double;
  using IndexType = std::uint32_t;
  double square = kInfinity;  // of the distance
  std::uint32_t number = 0;

  bool addPoint(double other, std::uint32_t i) {
    if (other < square || (other == square && i < number)) square = other, number = i;
    return true;
  }
  /// Points nearer than this are shown: also those that are as near as the nearest one so far.
  double worstDist() const { return std::nextafter(kRounding * square, kInfinity); }
  bool full() const { return true; }
  void sort() {}  // there is only one
};

}  // namespace

std::vector<std::uint32_t> nearest_points(std::span<const Vec3> points, std::span<const Vec3> places) {
  const PointCloud cloud{points};
  const PointTree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::vector<std::uint32_t> number(places.size());
  parallel_for(places.size(), [&](std::size_t i) {
    Nearest nearest;
    tree.findNeighbors(nearest, places[i].data(), {});
    number[i] = nearest.number;
  });
  return number;
}

std::vector<double> nearest_neighbour_squares(std::span<const Vec3> points) {
  const PointCloud cloud{points};
  const PointTree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::vector<double> square(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    std::array<std::uint32_t, 2> number;  // of the point itself and of its nearest neighbour
    std::array<double, 2> found;
    tree.knnSearch(points[i].data(), 2, number.data(), found.data());
    square[i] = found[1];
  });
  return square;
}

}  // namespace kappaflow
