// Finds the vertices of a mesh near some cells of a lattice.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "surface/mesh/triangle_mesh.h"
#include "surface/topology/cell_region.h"

namespace kappaflow {

/// Vertices by the blocks of cells that they lie in.
class VertexCells {
 public:
  explicit VertexCells(const SampledField& lattice) : lattice_(lattice) {}

  /// Enters the mesh's vertices from the first on that are not in it.
  void add(const TriangleMesh& mesh);

  /// Calls visit(v) for vertices that include those in the block's cells.
  template <class Visit>
  void for_each_in(const LatticeBlock& block, const Visit& visit) const {
    const LatticeCell first = coarser(block.first, kBin), last = coarser(block.last, kBin);
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j) {
        auto e = std::ranges::lower_bound(entries_, Entry{{k, j, first[0]}, -1});
        for (; e != entries_.end() && e->first <= LatticeCell{k, j, last[0]}; ++e) visit(e->second);
      }
  }

 private:
  static constexpr int kBin = 4;  // [cells]
  /// Of each vertex the bin's numbers, the last axis first, and its own.
  using Entry = std::pair<LatticeCell, int>;

  const SampledField& lattice_;
  std::vector<Entry> entries_;
};

}  // namespace kappaflow
