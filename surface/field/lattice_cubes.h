// The cubes of a lattice that boxes lie in, for Field::occupied_cubes().
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/sort_unique.h"
#include "core/whole_within.h"
#include "surface/field/field.h"

namespace kappaflow {

class LatticeCubes {
 public:
  /// Cubes so many cells of the lattice wide, numbered from its origin.
  LatticeCubes(const SampledField& lattice, int cells) : lattice_(lattice), cells_(cells) {}

  /// Adds those that the box of half the size `extent` [m] about `center` meets.
  void add(const Vec3& center, const Vec3& extent) {
    const Vec3 from_origin = center - lattice_.origin;
    const double size = cells_ * lattice_.spacing;
    const auto index = [&](int a, double side) {
      const int last = std::max(0, lattice_.dims[a] - 2) / cells_;
      return whole_within(std::floor((from_origin[a] + side * extent[a]) / size), 0, last);
    };
    for (int k = index(2, -1); k <= index(2, 1); ++k)
      for (int j = index(1, -1); j <= index(1, 1); ++j)
        for (int i = index(0, -1); i <= index(0, 1); ++i)
          if (const std::array cube{k, j, i}; cubes_.empty() || cubes_.back() != cube) cubes_.push_back(cube);
    if (cubes_.size() <= most_) return;
    sort_unique(cubes_);  // boxes that overlap have most of them several times
    most_ = std::max(most_, 2 * cubes_.size());
  }

  /// Each once, x y z, ascending by z, y, x.
  std::vector<std::array<int, 3>> ascending() && {
    sort_unique(cubes_);
    for (std::array<int, 3>& cube : cubes_) std::swap(cube[0], cube[2]);
    return std::move(cubes_);
  }

 private:
  const SampledField& lattice_;
  int cells_;
  std::vector<std::array<int, 3>> cubes_;    // z, y, x
  std::size_t most_ = std::size_t{1} << 20;  // in memory before those that are there twice go
};

}  // namespace kappaflow
