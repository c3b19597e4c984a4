#include "surface/mesh/lattice_blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/errors.h"
#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr double kMostPoints = 2147483648.0;  // 2^31: more is a mistake in the spacing
constexpr double kMargin = 0.01;              // [cells] around a triangle
constexpr double kMostWhole = 2;              // times the points of the cubes

double points_in(const LatticeBlock& block) {
  double points = 1;
  for (int a = 0; a < 3; ++a) points *= block.last[a] - block.first[a] + 1.0;
  return points;
}

void check_size(const SampledField& lattice, double points) {
  if (!(points <= kMostPoints))
    throw InvalidInput(
        fmt::format("an isosurface at spacing {} m needs {:.3g} lattice points; at most 2^31 are allowed",
                    lattice.spacing, points));
}

/// The first and the last cubes within `reach` cells of a triangle, along each axis.
std::pair<LatticeCube, LatticeCube> cubes_around(const SampledField& lattice, std::span<const Vec3> position,
                                                 const Triangle& triangle, double reach) {
  const Vec3 &x = position[triangle[0]], &y = position[triangle[1]], &z = position[triangle[2]];
  const Vec3 least = (x.cwiseMin(y).cwiseMin(z) - lattice.origin) / lattice.spacing,
             most = (x.cwiseMax(y).cwiseMax(z) - lattice.origin) / lattice.spacing;
  LatticeCube first{}, last{};
  for (int a = 0; a < 3; ++a) {
    const int end = std::max(0, lattice.dims[a] - 2) / kCubeCells;
    first[a] = whole_within(std::floor((least[a] - reach) / kCubeCells), 0, end);
    last[a] = whole_within(std::floor((most[a] + reach) / kCubeCells), 0, end);
  }
  return {first, last};
}

}  // namespace

LatticeBlock whole(const SampledField& lattice) {
  return {{0, 0, 0}, {lattice.dims[0] - 1, lattice.dims[1] - 1, lattice.dims[2] - 1}};
}

std::vector<LatticeCube> cubes_of(const SampledField& lattice, std::span<const Vec3> position,
                                  std::span<const Triangle> triangles) {
  std::vector<LatticeCube> cubes;
  for (const Triangle& t : triangles) {
    const auto [first, last] = cubes_around(lattice, position, t, kMargin);
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int i = first[0]; i <= last[0]; ++i)
          if (const LatticeCube cube{i, j, k}; cubes.empty() || cubes.back() != cube) cubes.push_back(cube);
  }
  return cubes;
}

std::vector<LatticeBlock> blocks_of(const SampledField& lattice, std::vector<LatticeCube> cubes) {
  const auto order = [](const LatticeCube& c) { return LatticeCube{c[2], c[1], c[0]}; };
  std::ranges::sort(cubes, {}, order);
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  std::vector<LatticeBlock> blocks;
  double points = 0;
  for (const LatticeCube& cube : cubes) {
    LatticeBlock& block = blocks.emplace_back();
    for (int a = 0; a < 3; ++a) {
      block.first[a] = cube[a] * kCubeCells;
      block.last[a] = std::min(block.first[a] + kCubeCells, lattice.dims[a] - 1);
    }
    points += points_in(block);
  }
  if (points_in(whole(lattice)) <= kMostWhole * points) {
    blocks = {whole(lattice)};
    points = points_in(blocks[0]);
  }
  check_size(lattice, points);
  return blocks;
}

std::vector<std::vector<Triangle>> triangles_in_rows(const SampledField& lattice,
                                                     std::span<const Vec3> position,
                                                     std::span<const Triangle> triangles,
                                                     std::span<const LatticeBlock> blocks, double reach) {
  std::vector<std::array<int, 3>> rows;  // of cubes: z, y, and a block in it
  for (int b = 0; b < static_cast<int>(blocks.size()); ++b)
    for (int k = blocks[b].first[2] / kCubeCells; k <= blocks[b].last[2] / kCubeCells; ++k)
      for (int j = blocks[b].first[1] / kCubeCells; j <= blocks[b].last[1] / kCubeCells; ++j)
        rows.push_back({k, j, b});
  std::ranges::sort(rows);
  std::vector<std::vector<Triangle>> result(blocks.size());
  for (const Triangle& t : triangles) {
    const auto [first, last] = cubes_around(lattice, position, t, reach);
    for (int k = first[2]; k <= last[2]; ++k) {
      auto row = std::ranges::lower_bound(rows, std::array{k, first[1], -1});
      for (; row != rows.end() && *row <= std::array{k, last[1], std::numeric_limits<int>::max()}; ++row) {
        const int b = (*row)[2];
        if (first[0] * kCubeCells > blocks[b].last[0]) continue;  // rows are crossed from their beginning on
        if (std::vector<Triangle>& of_block = result[b]; of_block.empty() || of_block.back() != t)
          of_block.push_back(t);
      }
    }
  }
  return result;
}

std::vector<LatticeBlock> occupied_blocks(const Field& field, const SampledField& lattice,
                                          std::vector<LatticeCube> others) {
  const auto cubes = field.occupied_cubes(lattice, kCubeCells);
  if (!cubes) {
    check_size(lattice, points_in(whole(lattice)));
    return {whole(lattice)};
  }
  others.insert(others.end(), cubes->begin(), cubes->end());
  return blocks_of(lattice, std::move(others));
}

}  // namespace kappaflow
