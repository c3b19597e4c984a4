// How often a closed mesh goes around the points of a lattice, and what of it the lattice can tell.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// The winding numbers of a closed oriented mesh at points of a lattice: 1 inside, 0 outside, others where
/// the mesh passes through itself. Crossings with the lattice's rows in x are found once, for all blocks
/// together. The rows lie 1.37e-7 and 2.91e-7 spacings beyond the points in y and z, so that they miss
/// vertices which lie on the lattice's edges. Crossings are counted modulo 256: beyond -128 ... 127 winding
/// numbers wrap around. Where the lattice begins inside the mesh, crossings before its first column count.
class WindingNumbers {
 public:
  /// Those at the points of the blocks. lattice: its values are not read.
  WindingNumbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                 const SampledField& lattice, std::span<const LatticeBlock> blocks);

  /// At the points of a part of a block, indexed as SampledField::value.
  std::vector<std::int8_t> in(const SampledField& part) const;

 private:
  struct Crossing {
    std::uint32_t row;
    std::int32_t column;  // of the first point beyond it
    std::int8_t step;     // of the winding number there
  };

  void find_tubes(std::span<const LatticeBlock> blocks);
  void cross_rows(const std::array<Vec3, 3>& corner, const Triangle& number,
                  std::vector<Crossing>& found) const;
  void cross_row(const std::array<Vec3, 3>& corner, const Triangle& number, int j, int k, std::uint32_t row,
                 std::vector<Crossing>& found) const;
  void sort_by_row(std::span<const std::vector<Crossing>> found);
  std::span<const Crossing> in_row(int j, int k) const;

  LatticeBlock all_;                  // holds the blocks
  std::vector<std::uint64_t> tubes_;  // squares of rows that blocks reach into, by z and y, ascending
  std::vector<std::size_t> start_;    // of the crossings of each row of each tube, and the end
  std::vector<Crossing> crossings_;   // by row
};

/// The mesh as the points of a lattice see it: the isosurface (see extract_isosurface()) between those inside
/// and those outside. Pieces, necks, holes and slits that pass between the points are not on it. lattice: as
/// isosurface_lattice() makes it, with the mesh inside.
TriangleMesh seen_by_lattice(const TriangleMesh& mesh, const SampledField& lattice);

}  // namespace kappaflow
