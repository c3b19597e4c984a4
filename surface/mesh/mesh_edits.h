// The one gate through which the connectivity of a mesh changes.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "core/connectivity.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// What may refuse edits beside the gate itself. An edit sweeps tetrahedra: triangle (a, b, c), of the mesh,
/// gives way to the three other sides of the one with x.
class EditGuard {
 public:
  virtual ~EditGuard() = default;
  /// Whether the tetrahedron may be swept. Must not depend on calls before; is called in parallel.
  virtual bool allows(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) const = 0;
};

/// The one gate through which the connectivity of a mesh changes. It refuses what would leave the mesh not a
/// closed oriented 2-manifold, and what the guard refuses; whether an edit is good for the shape is the
/// caller's question. An edit that is refused changes nothing. Vertices that an edit does not make or remove
/// keep their id and all that arrays hold of them; new ones get their entries by the arrays' rules (Carry).
///
/// An edit renumbers the half-edges (see core/connectivity.h) of the triangles that it touches; vertices keep
/// their numbers until finish().
class MeshEdits {
 public:
  /// Starts on a closed oriented mesh, which is borrowed until finish(), as is the guard; null: none. Throws
  /// TopologyError for a mesh that is not closed. Scratch is kept from one mesh to the next.
  void start(TriangleMesh& mesh, const EditGuard* guard = nullptr);
  /// Removes what collapses have left over. Vertices keep their order, so ids stay ascending; triangles too.
  void finish();

  const TriangleMesh& mesh() const { return *mesh_; }
  const Vec3& at(int v) const { return mesh_->position[v]; }
  int half_edges() const { return static_cast<int>(twin_.size()); }
  bool is_removed(int h) const { return mesh_->triangles[h / 3][0] < 0; }
  int origin(int h) const { return origin_of(mesh_->triangles, h); }
  int end(int h) const { return end_of(mesh_->triangles, h); }
  int apex(int h) const { return origin(previous_half_edge(h)); }  ///< the third corner of its triangle
  int twin(int h) const { return twin_[h]; }                       ///< the same edge the other way round
  bool is_alive(int v) const { return v < static_cast<int>(out_.size()) && out_[v] >= 0; }

  /// Calls visit(h) for every half-edge that starts at v, clockwise seen from outside.
  template <class Visit>
  void for_each_out(int v, const Visit& visit) const {
    int h = out_[v];
    do {
      visit(h);
      h = twin_[previous_half_edge(h)];
    } while (h != out_[v]);
  }
  /// Whether test(h) holds for all of them; asks no more after one for which it does not.
  template <class Test>
  bool all_out(int v, const Test& test) const {
    int h = out_[v];
    do {
      if (!test(h)) return false;
      h = twin_[previous_half_edge(h)];
    } while (h != out_[v]);
    return true;
  }
  int valence(int v) const;
  /// The half-edge from u to v; -1 where there is none, or one of them is gone.
  int find(int u, int v) const;

  /// How many edits have been made since start().
  std::uint32_t made() const { return made_; }
  /// Whether the triangles around v, and around all vertices up to `reach` edges from it, are as they were
  /// when so many edits had been made. v: a vertex then.
  bool is_as_it_was(int v, int reach, std::uint32_t made) const {
    return touched_[v] <= made && (reach == 0 || !is_alive(v) || all_out(v, [&](int out) {
                                     return is_as_it_was(end(out), reach - 1, made);
                                   }));
  }

  /// Puts a vertex at x on edge h; it comes from the edge's ends, from the end by `share`. Returns it, or -1
  /// where that is refused.
  int split(int h, double share, const Vec3& x);
  /// Whether it would not be refused; so of the others.
  bool can_split(int h, const Vec3& x) const;
  /// Puts a vertex at x into a triangle, joined with its three corners. Returns it, or -1.
  int split(int triangle, const VertexBlend& from, const Vec3& x);
  bool can_split_triangle(int triangle, const Vec3& x) const;
  /// Whether the origin of h may be joined with its end: the link condition, i.e. no vertex but the two
  /// apexes neighbours both, and each apex keeps three triangles; and what the guard says.
  bool can_collapse(int h) const;
  /// Removes the origin of h with two triangles; its other triangles go to the end of h. asked: whether
  /// can_collapse(h) has been, of the mesh as it is.
  bool collapse(int h, bool asked = false);
  /// Replaces edge h by the edge between its apexes; not where these are neighbours already or an end of h
  /// has three triangles only.
  bool flip(int h);
  /// Puts a new vertex at x in place of v. Returns it, or -1.
  int replace(int v, const VertexBlend& from, const Vec3& x);
  bool can_replace(int v, const Vec3& x) const { return allows_fan(v, x); }

  /// Puts a vertex at x on trial: it has a place, the field's gradient there, and whether it is on the
  /// surface, and no more. Returns it.
  int try_vertex(const Vec3& x, const Vec3& gradient, bool on_surface = true);
  /// The number of the first vertex on trial, if there is one.
  std::size_t first_tried() const { return out_.size(); }
  /// Takes the vertices on trial away.
  void discard_tried();
  /// Of the triangles to be added in exchange for those removed, those with which the mesh would not be
  /// closed, oriented and manifold, by number, ascending. Corners are vertices of the mesh or on trial.
  std::vector<int> misfits(std::span<const int> removed, std::span<const Triangle> added) const;
  /// Whether each edge along which removed triangles border on others is among those of the added ones.
  bool closes_rim(std::span<const int> removed, std::span<const Triangle> added) const;
  /// Takes triangles out and puts others in; makes the vertices on trial vertices of the mesh, from[i] saying
  /// where the i-th of them comes from; empty: all from nowhere. The guard is not asked: this is how the
  /// topology changes. Refused where there are misfits(), or where it is not closes_rim().
  [[nodiscard]] bool exchange(std::span<const int> removed, std::span<const Triangle> added,
                              std::span<const VertexBlend> from);
  /// Drops what exchange() took out from the mesh's triangles, which renumbers them.
  void drop_removed_triangles();

  void set_gradient(int v, const Vec3& gradient) { mesh_->gradient[v] = gradient; }

  /// After finish(): what became of the vertices.
  const VertexHistory& history() const { return history_; }

 private:
  void link(int h, int twin);
  /// For an edit that changes triangles of these vertices.
  void touch(std::initializer_list<int> vertices) {
    for (const int v : vertices) touched_[v] = made_;
  }
  void touch_fan(int v);
  bool allows(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) const {
    return guard_ == nullptr || guard_->allows(a, b, c, x);
  }
  bool allows_fan(int v, const Vec3& x) const;
  int add_vertex(const VertexBlend& from, const Vec3& x);
  std::vector<Triangle> staying_around(std::span<const int> removed, std::span<const Triangle> added) const;
  void take_out(std::span<const int> removed, std::vector<int>& open);
  void put_in(std::span<const Triangle> added, std::vector<int>& open);
  int add_triangle(const Triangle& triangle);
  void set_twins();
  void set_first_half_edges();

  TriangleMesh* mesh_ = nullptr;
  const EditGuard* guard_ = nullptr;
  std::vector<int> twin_;  // of each half-edge; meaningless where its triangle, {-1, -1, -1}, is removed
  std::vector<int> out_;   // a half-edge that starts at the vertex; -1 where it is gone
  std::vector<std::uint32_t> touched_;  // of each vertex: the edit that last changed a triangle of it, from 1
  std::uint32_t made_ = 0;
  VertexHistory history_;
  std::vector<char> alive_;
  EdgeSides sides_;  // scratch of set_twins()
};

}  // namespace kappaflow
