#include "surface/mesh/lattice_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/hashed_bins.h"
#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr double kMostPoints = 2147483648.0;  // 2^31: more is a mistake in the spacing
constexpr double kMargin = 0.01;              // [cells] around a triangle
constexpr double kMostWhole = 2;              // times the points of the cubes

void check_size(const SampledField& lattice, double points) {
  if (!(points <= kMostPoints))
    throw InvalidInput(
        fmt::format("an isosurface at spacing {} m needs {:.3g} lattice points; at most 2^31 are allowed",
                    lattice.spacing, points));
}

/// The first and the last cubes along each axis.
struct CubeRange {
  LatticeCube first{}, last{};
};

template <class Visit>
void for_each_cube(const CubeRange& range, const Visit& visit) {
  LatticeCube cube;
  for (cube[2] = range.first[2]; cube[2] <= range.last[2]; ++cube[2])
    for (cube[1] = range.first[1]; cube[1] <= range.last[1]; ++cube[1])
      for (cube[0] = range.first[0]; cube[0] <= range.last[0]; ++cube[0]) visit(cube);
}

/// Those within `reach` cells of a triangle's box.
CubeRange cubes_around(const SampledField& lattice, std::span<const Vec3> position, const Triangle& triangle,
                       double reach) {
  const Vec3 &x = position[triangle[0]], &y = position[triangle[1]], &z = position[triangle[2]];
  const Vec3 least = (x.cwiseMin(y).cwiseMin(z) - lattice.origin) / lattice.spacing,
             most = (x.cwiseMax(y).cwiseMax(z) - lattice.origin) / lattice.spacing;
  CubeRange cubes;
  for (int a = 0; a < 3; ++a) {
    const int end = std::max(0, lattice.dims[a] - 2) / kCubeCells;
    cubes.first[a] = whole_within(std::floor((least[a] - reach) / kCubeCells), 0, end);
    cubes.last[a] = whole_within(std::floor((most[a] + reach) / kCubeCells), 0, end);
  }
  return cubes;
}

/// Those of the block's cells; of a point, that of a cell at it.
CubeRange cubes_of_block(const SampledField& lattice, const LatticeBlock& block) {
  CubeRange cubes;
  for (int a = 0; a < 3; ++a) {
    const int last = std::max(0, lattice.dims[a] - 2);
    cubes.first[a] = std::clamp(block.first[a], 0, last) / kCubeCells;
    cubes.last[a] = std::clamp(std::max(block.first[a], block.last[a] - 1), 0, last) / kCubeCells;
  }
  return cubes;
}

}  // namespace

double points_in(std::span<const LatticeBlock> blocks) {
  double sum = 0;
  for (const auto& [first, last] : blocks) {
    double points = 1;
    for (int a = 0; a < 3; ++a) points *= last[a] - first[a] + 1.0;
    sum += points;
  }
  return sum;
}

LatticeBlock whole(const SampledField& lattice) {
  return {{0, 0, 0}, {lattice.dims[0] - 1, lattice.dims[1] - 1, lattice.dims[2] - 1}};
}

void restrict_to(const LatticeBlock& block, SampledField& samples) {
  samples.first_column = block.first[0];
  samples.first_row = block.first[1];
  samples.first_plane = block.first[2];
  for (int a = 0; a < 3; ++a) samples.dims[a] = block.last[a] - block.first[a] + 1;
}

std::vector<LatticeCube> cubes_of(const SampledField& lattice, std::span<const Vec3> position,
                                  std::span<const Triangle> triangles, double reach) {
  std::vector<LatticeCube> cubes;
  for (const Triangle& t : triangles)
    for_each_cube(cubes_around(lattice, position, t, reach + kMargin), [&](const LatticeCube& cube) {
      if (cubes.empty() || cubes.back() != cube) cubes.push_back(cube);
    });
  return cubes;
}

std::vector<LatticeBlock> blocks_of(const SampledField& lattice, std::vector<LatticeCube> cubes) {
  const auto order = [](const LatticeCube& c) { return LatticeCube{c[2], c[1], c[0]}; };
  std::ranges::sort(cubes, {}, order);
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  std::vector<LatticeBlock> blocks;
  for (const LatticeCube& cube : cubes) {
    LatticeBlock& block = blocks.emplace_back();
    for (int a = 0; a < 3; ++a) {
      block.first[a] = cube[a] * kCubeCells;
      block.last[a] = std::min(block.first[a] + kCubeCells, lattice.dims[a] - 1);
    }
  }
  if (points_in(std::array{whole(lattice)}) <= kMostWhole * points_in(blocks)) blocks = {whole(lattice)};
  check_size(lattice, points_in(blocks));
  return blocks;
}

std::vector<std::vector<int>> triangles_near(const SampledField& lattice, std::span<const Vec3> position,
                                             std::span<const Triangle> triangles,
                                             std::span<const LatticeBlock> blocks, double reach) {
  std::vector<HashedBins::Entry> by_cube;
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for_each_cube(cubes_of_block(lattice, blocks[b]), [&](const LatticeCube& cube) {
      by_cube.push_back({cell_key(cube), static_cast<int>(b)});
    });
  const HashedBins bins(by_cube);
  std::vector<std::vector<int>> result(blocks.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for_each_cube(cubes_around(lattice, position, triangles[t], reach + 1), [&](const LatticeCube& cube) {
      for (const auto& [key, b] : bins.near(cell_key(cube)))
        if (key == cell_key(cube) && (result[b].empty() || result[b].back() != static_cast<int>(t)))
          result[b].push_back(static_cast<int>(t));
    });
  return result;
}

std::vector<LatticeBlock> occupied_blocks(const Field& field, const SampledField& lattice,
                                          std::vector<LatticeCube> others) {
  const auto cubes = field.occupied_cubes(lattice, kCubeCells);
  if (!cubes) {
    check_size(lattice, points_in(std::array{whole(lattice)}));
    return {whole(lattice)};
  }
  others.insert(others.end(), cubes->begin(), cubes->end());
  return blocks_of(lattice, std::move(others));
}

}  // namespace kappaflow
