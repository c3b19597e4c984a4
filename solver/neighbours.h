// Who is near whom: sorting of the particles and the flat lists of neighbours with what every pair needs.
#pragma once

#include <cstdint>
#include <vector>

#include "core/cell_grid.h"
#include "solver/fluid_particles.h"
#include "solver/kernel.h"

namespace kappaflow {

/// Neighbours of each liquid particle within the kernel's support, itself left out, in compressed rows: the
/// pairs of particle i are [begin[i], begin[i+1]). Both directions of a pair are stored, so every loop is a
/// gather.
struct NeighbourLists {
  std::vector<std::size_t> begin;    ///< particles + 1 entries
  std::vector<std::uint32_t> index;  ///< j
  std::vector<Vec4f>
      gradient;  ///< V grad W(x_i - x_j) [1/m]; w: the pair's viscosity coefficient, see viscosity.h
};

/// Sorts particles and finds their neighbours; keeps its buffers, so that a step allocates nothing once warm.
class NeighbourSearch {
 public:
  explicit NeighbourSearch(float spacing) : kernel_(2 * spacing), volume_(spacing * spacing * spacing) {}

  /// Brings the state arrays of `particles` into cell order.
  void sort(FluidParticles& particles);

  /// Fills `lists` and, from the pairs of liquid alone, particles.density = V (W(0) + sum_j W_ij),
  /// gradient_sum = sum_j V grad W_ij and gradient_square_sum. Precondition: positions unchanged since
  /// sort().
  void find(FluidParticles& particles, NeighbourLists& lists);

 private:
  static constexpr std::size_t kChunk = 128;  // particles whose neighbours one task finds

  std::size_t find_in_chunk(std::size_t chunk, std::span<const Vec4f> position, NeighbourLists& lists);
  void evaluate(std::size_t i, FluidParticles& particles, NeighbourLists& lists) const;
  template <class T>
  void permute(std::vector<T>& array, std::vector<T>& buffer) const;

  CubicSpline kernel_;
  float volume_;
  CellGrid grid_;
  std::vector<std::vector<std::uint32_t>> found_;  // by chunk, with room to spare
  std::vector<std::size_t> found_count_;           // by chunk
  std::vector<float> x_, y_, z_;  // positions in cell order, for the vectorised distance test
  std::vector<Vec4f> vector_buffer_;
  std::vector<float> scalar_buffer_;
  std::vector<std::uint32_t> id_buffer_;
  std::vector<std::uint8_t> byte_buffer_;
};

}  // namespace kappaflow
