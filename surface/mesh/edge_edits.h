// Edits of a closed manifold mesh that keep it closed and manifold: split, collapse, flip, and a new vertex
// in place of an old one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// What a new vertex takes its attributes from: a convex combination of up to three vertices.
struct VertexBlend {
  std::array<int, 3> vertex;
  std::array<double, 3> weight;  ///< sum 1
};

/// sum_i weight_i values[vertex_i]
template <class T>
T blended(const std::vector<T>& values, const VertexBlend& from) {
  return from.weight[0] * values[from.vertex[0]] + from.weight[1] * values[from.vertex[1]] +
         from.weight[2] * values[from.vertex[2]];
}

/// The vertex with the largest weight, of several the first: for attributes that are names, not numbers.
int heaviest(const VertexBlend& from);

/// The one gate through which the connectivity of a mesh changes. It refuses what would leave the mesh not a
/// closed oriented 2-manifold of the same topology; whether an edit is good for the shape is the caller's
/// question. Vertices that an edit does not make or remove keep their id and attributes.
///
/// Half-edge h = 3 t + c runs from corner c of triangle t to the next corner. An edit renumbers half-edges of
/// the triangles that it touches; vertices keep their numbers until finish().
class EdgeEdits {
 public:
  /// Starts on a closed oriented mesh, which is borrowed until finish(). Scratch is kept from one mesh to the
  /// next.
  void start(TriangleMesh& mesh);
  /// Removes what collapses have left over. Vertices keep their order, so ids stay ascending; triangles too.
  void finish();

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int half_edges() const { return static_cast<int>(twin_.size()); }
  bool is_removed(int h) const { return mesh_->triangles[h / 3][0] < 0; }
  int origin(int h) const { return mesh_->triangles[h / 3][h % 3]; }
  int end(int h) const { return origin(next(h)); }
  int apex(int h) const { return origin(previous(h)); }  ///< the third corner of its triangle
  int twin(int h) const { return twin_[h]; }             ///< the same edge the other way round
  bool is_alive(int v) const { return out_[v] >= 0; }

  /// Calls visit(h) for every half-edge that starts at v, clockwise seen from outside.
  template <class Visit>
  void for_each_out(int v, const Visit& visit) const {
    int h = out_[v];
    do {
      visit(h);
      h = twin_[previous(h)];
    } while (h != out_[v]);
  }
  int valence(int v) const;
  /// The half-edge from u to v; -1 where there is none, or one of them is gone.
  int find(int u, int v) const;

  /// Puts a vertex at x on edge h; its attributes are blended between the edge's ends, `share` of the way
  /// from origin to end. Returns it.
  int split(int h, double share, const Vec3& x);
  /// Puts a vertex at x into a triangle, joined with its three corners. Returns it.
  int split(int triangle, const VertexBlend& attributes, const Vec3& x);
  /// Whether the origin of h may be joined with its end: the link condition, i.e. no vertex but the two
  /// apexes neighbours both, and each apex keeps three triangles.
  bool can_collapse(int h);
  /// Removes the origin of h with two triangles; its other triangles go to the end of h. Precondition:
  /// can_collapse(h).
  void collapse(int h);
  /// Replaces edge h by the edge between its apexes. Refused, and false, where these are neighbours already
  /// or an end of h has three triangles only.
  bool flip(int h);
  /// Puts a new vertex in place of v. Returns it.
  int replace(int v, const VertexBlend& attributes, const Vec3& x);

  /// After finish(): what became of the vertices.
  const VertexHistory& history() const { return history_; }

 private:
  void link(int h, int twin);
  int add_vertex(const VertexBlend& attributes, const Vec3& x);
  int add_triangle(const Triangle& triangle);
  void set_twins();

  TriangleMesh* mesh_ = nullptr;
  std::vector<int> twin_;  // of each half-edge; meaningless where its triangle, {-1, -1, -1}, is removed
  std::vector<int> out_;   // a half-edge that starts at the vertex; -1 where it is gone
  std::vector<std::uint32_t> mark_;  // of each vertex: the question it was last marked for
  std::uint32_t question_ = 0;
  VertexHistory history_;
  std::vector<char> alive_;
  std::vector<int> start_;                     // scratch of set_twins()
  std::vector<std::pair<int, int>> outgoing_;  // likewise: end and number of each half-edge, by origin
};

}  // namespace kappaflow
