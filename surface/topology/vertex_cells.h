// Finds the vertices of a mesh near some cells of a lattice.
#pragma once

#include <vector>

#include "core/hashed_bins.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/topology/cell_region.h"

namespace kappaflow {

/// Vertices by the blocks of cells that they lie in.
class VertexCells {
 public:
  explicit VertexCells(const SampledField& lattice) : lattice_(lattice) {}

  /// Enters the mesh's vertices from the first on that are not in it.
  void add(const TriangleMesh& mesh);

  /// Calls visit(v) for vertices that include those in the block's cells, each once.
  template <class Visit>
  void for_each_in(const LatticeBlock& block, const Visit& visit) const {
    const LatticeCell first = coarser(block.first, kBin), last = coarser(block.last, kBin);
    LatticeCell bin;
    for (bin[2] = first[2]; bin[2] <= last[2]; ++bin[2])
      for (bin[1] = first[1]; bin[1] <= last[1]; ++bin[1])
        for (bin[0] = first[0]; bin[0] <= last[0]; ++bin[0])
          for (const HashedBins& added : added_)
            for (const auto& [key, v] : added.near(cell_key(bin)))
              if (key == cell_key(bin)) visit(v);
  }

 private:
  static constexpr int kBin = 4;  // [cells]

  const SampledField& lattice_;
  std::vector<HashedBins> added_;  // by each call of add()
  std::size_t known_ = 0;          // vertices in them
};

}  // namespace kappaflow
