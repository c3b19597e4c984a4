// Who is near whom: sorting of the particles and the compressed lists of neighbours.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/cell_grid.h"
#include "core/wide.h"
#include "solver/fluid_particles.h"
#include "solver/kernel.h"

namespace kappaflow {

/// Eight neighbours j of a particle i, with the kernel's gradient V grad W(x_i - x_j) = V F (x_i - x_j) as
/// the rounded V F: 4.5 bytes a pair, for the loops over pairs are bound by memory. A pair's two directions
/// hold the same bits, so pair forces stay antisymmetric.
struct PairBlock {
  std::uint32_t base = 0;                   ///< the first j; they are ascending
  std::array<std::uint16_t, kWide> offset;  ///< j - base; 0 where the block is padded
  std::array<std::uint16_t, kWide> factor;  ///< -V F / NeighbourLists::unit, rounded, >= 1; 0 where padded

  /// 1 where there is a neighbour, 0 where the block is padded.
  Wide present() const { return widen(factor.data()).min(1.0f); }
};

/// The values of eight neighbours.
inline WideVec gather(const std::vector<Vec4f>& values, const PairBlock& block) {
  return gather(values.data() + block.base, block.offset.data());
}

/// FluidParticles::mass() of eight neighbours.
inline Wide masses(const FluidParticles& particles, const PairBlock& block) {
  Wide result;
  for (int k = 0; k < kWide; ++k)
    result[k] = particles.mass(block.base + block.offset[static_cast<std::size_t>(k)]);
  return result;
}

/// Neighbours of each liquid particle within the kernel's support, itself left out. Both directions of a pair
/// are stored, so every loop is a gather.
struct NeighbourLists {
  struct Row {
    std::uint32_t begin = 0, count = 0;  // of the blocks
  };
  std::vector<Row> rows;          ///< one a particle
  std::vector<PairBlock> blocks;  ///< the rows, each padded to whole blocks
  float unit = 1;                 ///< of PairBlock::factor [1/m2]

  std::size_t bytes() const { return bytes_of(rows, blocks); }
  std::span<const PairBlock> of(std::size_t i) const {
    return {blocks.data() + rows[i].begin, rows[i].count};
  }
  /// V F <= 0 of the eight pairs [1/m2]
  Wide factor(const PairBlock& block) const { return -unit * widen(block.factor.data()); }
};

/// Sorts particles and finds their neighbours; keeps its buffers, so that a step allocates nothing once warm.
class NeighbourSearch {
 public:
  explicit NeighbourSearch(float spacing);

  /// Brings the state arrays of `particles` into cell order.
  void sort(FluidParticles& particles);

  /// Fills `lists` and, from the pairs of liquid alone, particles.density = V (W(0) + sum_j W_ij),
  /// gradient_sum = sum_j V grad W_ij and gradient_square_sum. Precondition: positions unchanged since
  /// sort().
  void find(FluidParticles& particles, NeighbourLists& lists);

  std::size_t bytes() const { return grid_.bytes() + bytes_of(id_buffer_, temperature_buffer_); }

 private:
  static constexpr std::size_t kChunk = 128;    // particles whose neighbours one task finds
  static constexpr std::size_t kHeadroom = 64;  // the lists grow by this fraction more than needed

  /// What a thread needs to find the neighbours of a chunk of particles.
  struct Scratch {
    std::vector<float> x, y, z;            // the particles near a cell's, padded to whole blocks
    std::vector<std::uint32_t> candidate;  // which they are
    std::size_t candidates = 0;            // padding included
    std::vector<float> square;             // squared distances of the pairs, rows padded to whole blocks
    std::vector<std::uint32_t> found;      // their j
    std::size_t pairs = 0;                 // in both, padding included
    std::vector<NeighbourLists::Row> rows;
    std::vector<std::uint32_t> row;  // one, before it is cut
    std::vector<float> row_square;

    void collect(const CellGrid& grid, std::size_t begin, std::size_t end, const FluidParticles& particles,
                 float support);
    void append_row(std::uint32_t i, const Vec4f& xi, float support);
    void pad_row(std::size_t begin, std::size_t end, float support);
    std::size_t cut_row(std::size_t begin, std::size_t end, float support);
  };

  std::size_t fill(FluidParticles& particles, NeighbourLists& lists);
  void find_in_chunk(std::size_t chunk, const FluidParticles& particles, Scratch& scratch) const;
  void evaluate(std::size_t i, FluidParticles& particles, std::span<const float> square,
                std::span<const std::uint32_t> found, std::span<PairBlock> blocks) const;
  template <class T>
  void permute(std::vector<T>& array, std::vector<T>& buffer) const;
  /// By way of a buffer of numbers no narrower, which serves others too.
  template <class T, class Wider, class Widen, class Narrow>
  void permute_in_wider(std::vector<T>& array, std::vector<Wider>& buffer, const Widen& widen,
                        const Narrow& narrow) const;

  CubicSpline kernel_;
  float volume_, unit_;  // unit_: NeighbourLists::unit
  CellGrid grid_;
  tbb::enumerable_thread_specific<Scratch> scratch_;
  std::vector<std::uint32_t> id_buffer_;
  std::vector<double> temperature_buffer_;
};

}  // namespace kappaflow
