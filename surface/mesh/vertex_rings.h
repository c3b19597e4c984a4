// Which vertices share an edge: the one-ring neighbourhoods of a triangle mesh.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// One-ring neighbours in compressed rows: those of vertex v are neighbour[start[v]] ...
/// neighbour[start[v+1]-1], in ascending order.
struct VertexRings {
  std::vector<int> start;  // vertices + 1 entries
  std::vector<int> neighbour;

  std::span<const int> of(int v) const {
    return {neighbour.data() + start[v], static_cast<std::size_t>(start[v + 1] - start[v])};
  }
};

/// The one-rings of a mesh with `vertex_count` vertices.
VertexRings vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles);
/// The same into `rings`, whose memory is used again.
void vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles, VertexRings& rings);

}  // namespace kappaflow
