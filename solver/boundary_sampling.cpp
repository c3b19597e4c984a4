#include "solver/boundary_sampling.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

#include "core/cell_grid.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/split_mix.h"

namespace kappaflow {
namespace {

constexpr double kMinDistance = 0.6;        // between samples, in spacings
constexpr double kCandidateDistance = 0.2;  // between candidates, in spacings
constexpr std::size_t kBlock = 1 << 18;     // of candidates whose distances are known at a time

/// Where samples may lie; some 25 for every sample that there will be, so they are kept small.
struct Candidates {
  std::vector<Vec3> position;       ///< [m]
  std::vector<std::uint32_t> face;  ///< that it lies under
  std::vector<Vec3> normal;         ///< of each face

  const Vec3& normal_of(std::size_t i) const { return normal[face[i]]; }
};

/// Throws InvalidInput for walls with more candidates than can be told apart.
void check_number_of_candidates(std::span<const SolidWall> walls, double step) {
  constexpr double kMost = std::numeric_limits<std::uint32_t>::max();
  double candidates = 0;
  for (const SolidWall& wall : walls)
    for (const auto& [i, j, k] : wall.surface().triangles) {
      const std::vector<Vec3>& vertices = wall.surface().vertices;
      const Vec3 &a = vertices[i], &b = vertices[j], &c = vertices[k];
      const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}),
                   height =
                       (b - a).cross(c - a).norm() / std::max(longest, std::numeric_limits<double>::min());
      candidates += (longest / step + 2) * (height / step + 2);
    }
  if (!(candidates <= kMost))
    throw InvalidInput(
        fmt::format("wall: so large that its particles would be chosen from {:.3g} places; "
                    "at most {:.3g} are allowed, with a larger spacing or smaller walls",
                    candidates, kMost));
}

/// Appends points that cover abc, its border included, no further than `step` apart in rows along its longest
/// edge; moved `depth` against the face's normal.
void append_rows(Vec3 a, Vec3 b, Vec3 c, double depth, double step, Candidates& candidates) {
  const Vec3 normal = (b - a).cross(c - a).stableNormalized();
  if (normal.squaredNorm() == 0) return;
  const auto face = static_cast<std::uint32_t>(candidates.normal.size());
  candidates.normal.push_back(normal);
  // The first of the longest. Each length is computed once: two that are equal could else each be the shorter
  // one, by their rounding.
  const std::array square{(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()};
  for (auto turns = std::ranges::max_element(square) - square.begin(); turns > 0; --turns) {
    std::swap(a, b);
    std::swap(b, c);
  }
  const double height = (c - a).cross(b - a).norm() / (b - a).norm();
  const int rows = static_cast<int>(std::ceil(height / step));
  for (int row = 0; row <= rows; ++row) {
    const double t = static_cast<double>(row) / rows;
    const Vec3 first = a + t * (c - a) - depth * normal, length = (1 - t) * (b - a);
    const int columns = static_cast<int>(std::ceil(length.norm() / step));
    for (int k = 0; k <= columns; ++k) {
      candidates.position.push_back(first + (static_cast<double>(k) / std::max(columns, 1)) * length);
      candidates.face.push_back(face);
    }
  }
}

/// The boxes of all solids, wider by `margin`.
std::vector<Eigen::AlignedBox3d> boxes_of_solids(std::span<const SolidWall> walls, double margin) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SolidWall& wall : walls)
    for (const Eigen::AlignedBox3d& box : wall.boxes())
      boxes.emplace_back(box.min() - Vec3::Constant(margin), box.max() + Vec3::Constant(margin));
  return boxes;
}

/// Whether a point of a solid's surface is inside another solid, where no liquid touches it. boxes: a quick
/// answer for most.
bool is_covered(std::span<const SolidWall> walls, std::span<const Eigen::AlignedBox3d> boxes, const Vec3& x,
                double depth) {
  if (std::ranges::count_if(boxes, [&](const auto& box) { return box.contains(x); }) < 2) return false;
  return nearest_of_walls(walls, x).distance < -1e-3 * depth;
}

/// Whether a candidate is `depth` deep in the union, of which `nearest` is the nearest point: those below a
/// convex edge are less, and would compress the liquid around it; those that another solid covers are more.
bool is_at_depth(const SurfacePoint& nearest, const Vec3& normal, double depth) {
  const Vec3& x = nearest.position;
  if (nearest.distance > -0.999 * depth && nearest.normal.dot(normal) < -0.9)
    throw InvalidInput(
        fmt::format("wall: thinner than {:.4g} m, {} particle spacings, at ({:.4g}, {:.4g}, {:.4g}); "
                    "make it thicker or lower the spacing",
                    2 * depth, kThinnestWall, x.x(), x.y(), x.z()));
  return std::abs(nearest.distance + depth) < 1e-3 * depth;
}

/// Removes the candidates that are not `depth` deep.
void keep_at_depth(Candidates& candidates, std::span<const SolidWall> walls, double depth) {
  const std::vector<Eigen::AlignedBox3d> boxes = boxes_of_solids(walls, 1e-3 * depth);
  std::vector<SurfacePoint> nearest;
  std::vector<char> covered;
  std::size_t kept = 0;
  for (std::size_t begin = 0; begin < candidates.position.size(); begin += kBlock) {
    nearest.resize(std::min(kBlock, candidates.position.size() - begin));
    covered.resize(nearest.size());
    parallel_for(nearest.size(), [&](std::size_t i) {
      const Vec3& x = candidates.position[begin + i];
      nearest[i] = nearest_of_walls(walls, x);
      covered[i] = is_covered(walls, boxes, x + depth * candidates.normal_of(begin + i), depth);
    });
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      if (covered[i] || !is_at_depth(nearest[i], candidates.normal_of(begin + i), depth)) continue;
      candidates.position[kept] = candidates.position[begin + i];
      candidates.face[kept++] = candidates.face[begin + i];
    }
  }
  candidates.position.resize(kept);
  candidates.face.resize(kept);
}

/// The numbers below n in pseudo-random order. What they are scrambled to is computed at each comparison: to
/// keep it beside them would add twelve bytes a candidate.
std::vector<std::uint32_t> random_order(std::size_t n) {
  std::vector<std::uint32_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0u);
  std::ranges::sort(numbers, {}, [](std::uint32_t i) { return split_mix(i); });
  return numbers;
}

/// Greedy maximal subset with no two points under the same side nearer than `distance`, visited in
/// pseudo-random order.
std::vector<WallSample> poisson_disk_subset(const Candidates& candidates, double distance) {
  const std::span<const Vec3> points = candidates.position;
  CellGrid grid;
  grid.build(points, distance);
  const auto cell_order = grid.order();
  std::vector<char> taken(points.size(), 0);  // by place in cell order
  std::vector<std::uint32_t> place(points.size());
  for (std::size_t k = 0; k < cell_order.size(); ++k) place[cell_order[k]] = static_cast<std::uint32_t>(k);
  std::vector<WallSample> samples;
  for (const std::uint32_t i : random_order(points.size())) {
    bool free = true;
    grid.ranges_near(points[i], distance, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end && free; ++k)
        free = !taken[k] || (points[cell_order[k]] - points[i]).squaredNorm() >= distance * distance ||
               opposite(candidates.normal_of(cell_order[k]), candidates.normal_of(i));
    });
    if (!free) continue;
    taken[place[i]] = 1;
    samples.push_back({points[i], candidates.normal_of(i)});
  }
  return samples;
}

}  // namespace

std::vector<WallSample> sample_walls(std::span<const SolidWall> walls, double spacing) {
  const double depth = kWallDepth * spacing, step = kCandidateDistance * spacing;
  check_number_of_candidates(walls, step);
  Candidates candidates;
  for (const SolidWall& wall : walls)
    for (const auto& [i, j, k] : wall.surface().triangles) {
      const std::vector<Vec3>& vertices = wall.surface().vertices;
      append_rows(vertices[i], vertices[j], vertices[k], depth, step, candidates);
    }
  keep_at_depth(candidates, walls, depth);
  return poisson_disk_subset(candidates, kMinDistance * spacing);
}

}  // namespace kappaflow
