// What became of the vertices of a mesh in the course of edits.
#pragma once

#include <cstddef>
#include <vector>

namespace kappaflow {

/// Edits number new vertices after the old ones; at their end those that are gone are left out.
struct VertexHistory {
  std::vector<int> number;    ///< that each vertex had before the renumbering, ascending
  int vertices_at_start = 0;  ///< those with lower numbers were there before the edits
  std::vector<char> touched;  ///< of each vertex whether triangles of it have changed; after the renumbering

  /// The vertex's number before the edits; -1 where they made it.
  int before(int v) const { return number[v] < vertices_at_start ? number[v] : -1; }
  /// Renumbers an array over the vertices, new ones included.
  template <class T>
  void keep(std::vector<T>& values) const {
    for (std::size_t v = 0; v < number.size(); ++v) values[v] = values[number[v]];
    values.resize(number.size());
  }
};

}  // namespace kappaflow
