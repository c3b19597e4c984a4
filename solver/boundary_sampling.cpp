#include "solver/boundary_sampling.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/cell_grid.h"
#include "core/errors.h"
#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr double kMinDistance = 0.6;        // between samples, in spacings
constexpr double kCandidateDistance = 0.2;  // between candidates, in spacings

/// A fixed pseudo-random permutation of the 64-bit integers (splitmix64).
std::uint64_t scramble(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// Appends points that cover abc, its border included, no further than `step` apart in rows along its longest
/// edge; moved `depth` against the face's normal.
void append_rows(Vec3 a, Vec3 b, Vec3 c, double depth, double step, std::vector<WallSample>& candidates) {
  const Vec3 normal = (b - a).cross(c - a).stableNormalized();
  if (normal.squaredNorm() == 0) return;
  while ((b - a).squaredNorm() < std::max((c - b).squaredNorm(), (a - c).squaredNorm())) {
    std::swap(a, b);
    std::swap(b, c);
  }
  const double height = (c - a).cross(b - a).norm() / (b - a).norm();
  const int rows = static_cast<int>(std::ceil(height / step));
  for (int row = 0; row <= rows; ++row) {
    const double t = static_cast<double>(row) / rows;
    const Vec3 first = a + t * (c - a) - depth * normal, length = (1 - t) * (b - a);
    const int columns = static_cast<int>(std::ceil(length.norm() / step));
    for (int k = 0; k <= columns; ++k)
      candidates.push_back({first + (static_cast<double>(k) / std::max(columns, 1)) * length, normal});
  }
}

/// The candidates that are `depth` deep in the union: those below a convex edge are less, and would compress
/// the liquid around it; those that another solid covers are more.
std::vector<WallSample> at_depth(const std::vector<WallSample>& candidates,
                                 std::span<const SolidDistance> solids, double depth) {
  std::vector<SurfacePoint> nearest(candidates.size());
  parallel_for(candidates.size(),
               [&](std::size_t i) { nearest[i] = nearest_of_union(solids, candidates[i].position); });
  std::vector<WallSample> kept;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Vec3& x = nearest[i].position;
    if (nearest[i].distance > -0.999 * depth && nearest[i].normal.dot(candidates[i].normal) < -0.9)
      throw InvalidInput(
          fmt::format("wall: thinner than {:.4g} m, {} particle spacings, at ({:.4g}, {:.4g}, {:.4g}); "
                      "make it thicker or lower the spacing",
                      2 * depth, kThinnestWall, x.x(), x.y(), x.z()));
    if (std::abs(nearest[i].distance + depth) < 1e-3 * depth) kept.push_back(candidates[i]);
  }
  return kept;
}

/// Greedy maximal subset with no two points under the same side nearer than `distance`, visited in
/// pseudo-random order.
std::vector<WallSample> poisson_disk_subset(const std::vector<WallSample>& candidates, double distance) {
  std::vector<Vec3> points(candidates.size());
  std::ranges::transform(candidates, points.begin(), &WallSample::position);
  CellGrid grid;
  grid.build(std::span<const Vec3>(points), distance);
  const auto cell_order = grid.order();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> visits(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) visits[i] = {scramble(i), i};
  std::sort(visits.begin(), visits.end());
  std::vector<char> taken(points.size(), 0);  // by place in cell order
  std::vector<std::uint32_t> place(points.size());
  for (std::size_t k = 0; k < cell_order.size(); ++k) place[cell_order[k]] = static_cast<std::uint32_t>(k);
  std::vector<WallSample> samples;
  for (const auto& visit : visits) {
    const std::uint32_t i = visit.second;
    bool free = true;
    grid.ranges_near(points[i], distance, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end && free; ++k)
        free = !taken[k] || (points[cell_order[k]] - points[i]).squaredNorm() >= distance * distance ||
               opposite(candidates[cell_order[k]].normal, candidates[i].normal);
    });
    if (!free) continue;
    taken[place[i]] = 1;
    samples.push_back(candidates[i]);
  }
  return samples;
}

}  // namespace

std::vector<WallSample> sample_walls(std::span<const TriangleSurface> walls,
                                     std::span<const SolidDistance> solids, double spacing) {
  const double depth = kWallDepth * spacing;
  std::vector<WallSample> candidates;
  for (const TriangleSurface& wall : walls)
    for (const Triangle& t : wall.triangles)
      append_rows(wall.vertices[t[0]], wall.vertices[t[1]], wall.vertices[t[2]], depth,
                  kCandidateDistance * spacing, candidates);
  return poisson_disk_subset(at_depth(candidates, solids, depth), kMinDistance * spacing);
}

}  // namespace kappaflow
