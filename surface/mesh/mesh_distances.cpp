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

/// Values weighted 1, 26, 66, 26, 1 along one axis, beyond whose ends they stay as they are.
std::vector<float> blurred(const RegularGrid& grid, const std::vector<float>& value, int axis) {
  constexpr std::array<float, 5> kWeights{1.0F / 120, 26.0F / 120, 66.0F / 120, 26.0F / 120, 1.0F / 120};
  std::vector<float> result(value.size());
  const int nx = grid.dims[0], ny = grid.dims[1];
  parallel_for(
      static_cast<std::size_t>(ny) * static_cast<std::size_t>(grid.dims[2]),
      [&](std::size_t row) {
        const int j = static_cast<int>(row) % ny, k = static_cast<int>(row) / ny;
        for (int i = 0; i < nx; ++i) {
          float sum = 0;
          for (int d = -2; d <= 2; ++d) {
            std::array<int, 3> at{i, j, k};
            at[axis] = std::clamp(at[axis] + d, 0, grid.dims[axis] - 1);
            sum += kWeights[d + 2] * value[grid.index(at[0], at[1], at[2])];
          }
          result[grid.index(i, j, k)] = sum;
        }
      },
      16);
  return result;
}

/// Leaves waves of ten spacings as they are, to 1 %, and less than a third of those of three, which are the
/// mesh's facets and spoil third derivatives: 1 - (1 - B^2)^3, B the values of quintic B-splines at the
/// points.
void smooth(const RegularGrid& grid, std::vector<float>& value) {
  std::vector<float> rest = value;
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<float> wide = rest;
    for (int twice = 0; twice < 2; ++twice)
      for (int axis = 0; axis < 3; ++axis) wide = blurred(grid, wide, axis);
    for (std::size_t p = 0; p < rest.size(); ++p) rest[p] -= wide[p];
  }
  for (std::size_t p = 0; p < value.size(); ++p) value[p] -= rest[p];
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
  smooth(grid, result.value);
  return result;
}

}  // namespace kappaflow
