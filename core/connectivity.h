// How triangles hang together: which share an edge or a vertex, where they end, and which pieces they form.
//
// Everything about edges follows from one list, the half-edges sorted by their edges (EdgeSides). The
// triangles may be a mesh or any part of one, closed or open, manifold or not. Time and memory grow with
// their number, not with the numbers of their vertices; where a function has an entry for each vertex, it
// takes the number of vertices. It lies in core, and knows nothing but the numbers of vertices, because walls
// need it as meshes do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Half-edge h = 3 t + c runs from corner c of triangle t to the next corner.
inline int next_half_edge(int h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
inline int previous_half_edge(int h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
inline int origin_of(std::span<const Triangle> triangles, int h) {
  return triangles[h / 3][h % 3];
}
inline int end_of(std::span<const Triangle> triangles, int h) {
  return origin_of(triangles, next_half_edge(h));
}

/// The half-edges along each edge, whichever way they run, in compressed rows.
class EdgeSides {
 public:
  EdgeSides() = default;
  explicit EdgeSides(std::span<const Triangle> triangles) { assign(triangles); }
  /// The same for other triangles; memory is used again.
  void assign(std::span<const Triangle> triangles);

  /// How many edges there are. They are numbered by their lower, then by their higher vertex.
  std::size_t edges() const { return start_.size() - 1; }
  /// The half-edges along edge e, ascending.
  std::span<const int> of(std::size_t e) const {
    return {half_edge_.data() + start_[e], static_cast<std::size_t>(start_[e + 1] - start_[e])};
  }

 private:
  std::vector<int> start_{0};  // of each edge, in half_edge_; edges + 1 entries
  std::vector<int> half_edge_;
  std::vector<int> bucket_;         // scratch of assign(): where each bucket begins
  std::vector<std::uint64_t> key_;  // likewise: half-edges as they are sorted
};

/// Of each half-edge the one on the other side of its edge; -1 where the edge does not have exactly two
/// triangles, which run along it in opposite directions. In a closed oriented mesh there is no -1.
std::vector<int> twins_of(std::span<const Triangle> triangles);
/// The same into `twin`; memory is used again.
void twins_of(std::span<const Triangle> triangles, EdgeSides& scratch, std::vector<int>& twin);

/// The boundary of a set of triangles: directed edges (u, v) as often as they occur more often than (v, u).
struct Boundary {
  std::vector<std::vector<int>>
      loops;                 ///< vertices in the order of the edges, each from its smallest; sorted by it
  std::vector<int> pinched;  ///< vertices where several edges start; without loops then
};
Boundary boundary_of(std::span<const Triangle> triangles);

/// One-ring neighbours in compressed rows: those of vertex v are neighbour[start[v]] ...
/// neighbour[start[v+1]-1], in ascending order.
struct VertexRings {
  std::vector<int> start;  // vertices + 1 entries
  std::vector<int> neighbour;

  std::span<const int> of(int v) const {
    return {neighbour.data() + start[v], static_cast<std::size_t>(start[v + 1] - start[v])};
  }
  /// The place of edge (u, v) in `neighbour`; -1 where there is none.
  int place_of(int u, int v) const {
    const std::span<const int> ring = of(u);
    const auto found = std::ranges::lower_bound(ring, v);
    return found != ring.end() && *found == v ? start[u] + static_cast<int>(found - ring.begin()) : -1;
  }
};

/// The one-rings of a mesh with `vertex_count` vertices: which share an edge.
VertexRings vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles);
/// The same into `rings`; memory is used again.
void vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles, VertexRings& rings);

/// The connected piece of each triangle, numbered from 0 by first triangle. Triangles that share an edge are
/// connected, those that merely share a vertex are not: at a vertex several pieces may touch.
std::vector<int> triangle_pieces(std::span<const Triangle> triangles);

/// The connected piece of each vertex, numbered from 0 by first vertex. Vertices are connected that share a
/// triangle, so pieces that touch at a vertex are one. A vertex without triangles is a piece of its own.
std::vector<int> vertex_pieces(std::size_t vertex_count, std::span<const Triangle> triangles);

/// The members of each piece, ascending. piece: of each member, numbered from 0 by first member.
std::vector<std::vector<int>> members_by_piece(std::span<const int> piece);

}  // namespace kappaflow
