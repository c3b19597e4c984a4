#include "surface/topology/vertex_cells.h"

#include "surface/topology/disagreement.h"

namespace kappaflow {

void VertexCells::add(const TriangleMesh& mesh) {
  const auto known = static_cast<std::ptrdiff_t>(entries_.size());
  for (std::size_t v = entries_.size(); v < mesh.vertex_count(); ++v) {
    const auto [i, j, k] = coarser(cell_of(lattice_, mesh.position[v]), kBin);
    entries_.push_back({{k, j, i}, static_cast<int>(v)});
  }
  std::sort(entries_.begin() + known, entries_.end());
  std::inplace_merge(entries_.begin(), entries_.begin() + known, entries_.end());
}

}  // namespace kappaflow
