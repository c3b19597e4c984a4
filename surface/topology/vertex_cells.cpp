#include "surface/topology/vertex_cells.h"

#include "surface/topology/disagreement.h"

namespace kappaflow {

void VertexCells::add(const TriangleMesh& mesh) {
  std::vector<HashedBins::Entry> entries;
  for (; known_ < mesh.vertex_count(); ++known_) {
    const LatticeCell bin = coarser(cell_of(lattice_, mesh.position[known_]), kBin);
    entries.push_back({cell_key(bin), static_cast<int>(known_)});
  }
  if (!entries.empty()) added_.emplace_back(entries);
}

}  // namespace kappaflow
