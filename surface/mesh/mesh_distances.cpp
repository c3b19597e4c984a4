#include "surface/mesh/mesh_distances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/solids.h"

namespace kappaflow {
namespace {

constexpr double kMostGridPoints = 2147483648.0;  // 2^31
constexpr int kCube = 8;  // [points] along a side: far from the surface one distance tells that of all

RegularGrid grid_around(const TriangleSurface& surface, double spacing, double reach) {
  Vec3 lower = Vec3::Constant(kInfinity), upper = -lower;
  for (const Vec3& x : surface.vertices) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vec3 first = ((lower.array() - reach) / spacing).floor();
  const Vec3 points = ((upper.array() + reach) / spacing).ceil() - first.array() + 1;
  if (!(points.prod() < kMostGridPoints) || !(first.cwiseAbs().maxCoeff() < kMostGridPoints / 2))
    throw InvalidInput(
        fmt::format("a grid of {:.3g} x {:.3g} x {:.3g} points around a mesh; at most 2^31 are "
                    "allowed",
                    points[0], points[1], points[2]));
  RegularGrid grid{.spacing = Vec3::Constant(spacing)};
  for (int a = 0; a < 3; ++a) {
    grid.first[a] = static_cast<int>(first[a]);
    grid.dims[a] = static_cast<int>(points[a]);
  }
  return grid;
}

}  // namespace

SignedDistances signed_distances(const TriangleSurface& surface, double spacing, double reach) {
  check_surface(surface);
  check_crossings(surface);
  const std::vector<SolidDistance> solids = solid_distances({&surface, 1});
  SignedDistances result{.grid = grid_around(surface, spacing, reach), .value = {}};
  const RegularGrid& grid = result.grid;
  result.value.resize(grid.size());
  std::array<int, 3> cubes;
  for (int a = 0; a < 3; ++a) cubes[a] = (grid.dims[a] + kCube - 1) / kCube;
  const double half_diagonal = std::sqrt(3.0) / 2 * kCube * spacing;
  const auto distance = [&](const Vec3& x) { return nearest_of_union(solids, x).distance; };
  parallel_for(
      static_cast<std::size_t>(cubes[0]) * cubes[1] * cubes[2],
      [&](std::size_t c) {
        const std::array<int, 3> begin{static_cast<int>(c % cubes[0]) * kCube,
                                       static_cast<int>(c / cubes[0] % cubes[1]) * kCube,
                                       static_cast<int>(c / cubes[0] / cubes[1]) * kCube};
        const double middle =
            distance(grid.point(begin[0], begin[1], begin[2]) + Vec3::Constant(spacing * (kCube - 1) / 2.0));
        const bool is_far = std::abs(middle) > reach + half_diagonal;
        for (int k = begin[2]; k < std::min(begin[2] + kCube, grid.dims[2]); ++k)
          for (int j = begin[1]; j < std::min(begin[1] + kCube, grid.dims[1]); ++j)
            for (int i = begin[0]; i < std::min(begin[0] + kCube, grid.dims[0]); ++i)
              result.value[grid.index(i, j, k)] = static_cast<float>(
                  std::clamp(is_far ? middle : distance(grid.point(i, j, k)), -reach, reach));
      },
      1);
  return result;
}

}  // namespace kappaflow
