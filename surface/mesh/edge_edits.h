// Edits of a closed manifold mesh that keep it closed and manifold: edge collapse and edge flip.
#pragma once

#include <array>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Edits the positions and triangles of a closed oriented manifold mesh in place. Every edit is refused, and
/// changes nothing, where the mesh would not stay manifold or a triangle would turn by a right angle or more.
class EdgeEdits {
 public:
  /// Both arrays are borrowed and must outlive this object.
  EdgeEdits(std::vector<Vec3>& position, std::vector<Triangle>& triangles);

  /// Joins the ends of edge (u, v) at its midpoint: v goes, with two triangles. longest: no edge longer than
  /// this may result [m].
  bool collapse(int u, int v, double longest);

  /// Replaces edge (u, v) by the edge between the two vertices opposite to it.
  bool flip(int u, int v);

  /// The vertices opposite to edge (u, v): of the triangle that runs from u to v, then of the one from v to
  /// u.
  /// {-1, -1} where there is no such edge.
  std::array<int, 2> opposite(int u, int v) const;

  /// Removes what collapses have left over; vertices and triangles keep their order. Ends the editing.
  void compact();

 private:
  int triangle_along(int u, int v) const;
  bool are_neighbours(int u, int v) const;
  int common_neighbours(int u, int v) const;
  Vec3 area_vector(const Triangle& triangle) const;
  bool allows_move(int v, int other, const Vec3& target, double longest) const;
  void detach(int triangle, int vertex);

  std::vector<Vec3>& position_;
  std::vector<Triangle>& triangles_;            // {-1, -1, -1} where removed
  std::vector<std::vector<int>> triangles_of_;  // of each vertex; empty where removed
};

}  // namespace kappaflow
