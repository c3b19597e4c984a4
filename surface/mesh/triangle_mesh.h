// The tracked mesh: vertices with their attributes, and triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/mesh/vertex_history.h"
#include "surface/mesh/vertex_rings.h"

namespace kappaflow {

/// In place of a triangle that edits have taken out.
inline constexpr Triangle kRemovedTriangle{-1, -1, -1};

/// In place of the source of a vertex, where nobody has said it.
inline constexpr int kUnknownSource = -1;

/// An oriented triangle mesh, counter-clockwise seen from outside. Vertex arrays have one entry a vertex.
struct TriangleMesh {
  std::vector<Vec3> position;       ///< [m]
  std::vector<Vec3> rest_position;  ///< position in the initial mesh [m]: a seamless 3D texture coordinate
  std::vector<int> source;          ///< block or emitter of the liquid under it, or kUnknownSource
  std::vector<char> unprojected;    ///< 1 where the last projection on f = 0 failed
  std::vector<std::int64_t> id;     ///< ascending; of one vertex for as long as it lives, never used again
  std::int64_t next_id = 0;         ///< of the next vertex to be born
  std::vector<Triangle> triangles;

  std::size_t vertex_count() const { return position.size(); }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(position, rest_position, source, unprojected, id, next_id, triangles);
  }
};

/// What is known at every vertex of a mesh beside its attributes; one entry a vertex.
struct VertexFacts {
  std::vector<Vec3>& gradient;    ///< grad f at the vertex
  std::vector<double>& mobility;  ///< see vertex_mobility()
};

/// A mesh at rest: rest_position = position, no source known, all vertices projected, ids from 0.
TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles);

/// How many vertices have an id below `id`; they come first.
std::size_t vertices_older_than(const TriangleMesh& mesh, std::int64_t id);

/// Takes out the vertices for which `alive` is 0, and triangles {-1, -1, -1}. The rest keeps its order, so
/// ids stay ascending; history.number says where each was.
void remove_dead(std::span<const char> alive, TriangleMesh& mesh, VertexHistory& history);

}  // namespace kappaflow
