// The tracked mesh: vertices with their arrays, and triangles.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/connectivity.h"
#include "surface/mesh/vertex_arrays.h"
#include "surface/mesh/vertex_history.h"

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
  std::vector<Vec3> gradient;       ///< grad f where the vertex was put on the surface; zero before [1/m]
  std::vector<double> mobility;     ///< share of its move that fairing leaves the vertex, in [0, 1]
  std::vector<std::int64_t> id;     ///< ascending; of one vertex for as long as it lives, never used again
  std::int64_t next_id = 0;         ///< of the next vertex to be born
  std::vector<VertexArray> added;   ///< by add_array()
  std::vector<Triangle> triangles;

  std::size_t vertex_count() const { return position.size(); }

  /// Registers an array, which every edit carries along by the rule, and which files and checkpoints hold.
  /// All vertices start with `fresh`. T: double, Vec3 or int; int is not interpolated. Throws InvalidInput
  /// for a name that is taken, with no change.
  template <class T>
  std::span<T> add_array(std::string_view name, Carry carry, const T& fresh);
  /// The entries of an added array. Throws InvalidInput for a name or type that there is not.
  template <class T>
  std::span<T> array(std::string_view name);
  template <class T>
  std::span<const T> array(std::string_view name) const;

  /// Calls visit(name, carry, values, fresh) for every array over the vertices but `position`. mesh: const or
  /// not.
  template <class Mesh, class Visit>
  static void for_each_array(Mesh& mesh, const Visit& visit) {
    for_each_own_array(mesh, visit);
    for (auto& array : mesh.added)
      std::visit([&](auto& data) { visit(array.name, array.carry, data.values, data.fresh); }, array.data);
  }
  /// The same for those that every mesh has: here they are registered.
  template <class Mesh, class Visit>
  static void for_each_own_array(Mesh& mesh, const Visit& visit) {
    visit("rest_position", Carry::interpolate, mesh.rest_position, Vec3(Vec3::Zero()));
    visit("source", Carry::nearest, mesh.source, kUnknownSource);
    visit("unprojected", Carry::recompute, mesh.unprojected, char{0});
    visit("gradient", Carry::recompute, mesh.gradient, Vec3(Vec3::Zero()));
    visit("mobility", Carry::interpolate, mesh.mobility, 1.0);
    visit("id", Carry::recompute, mesh.id, std::int64_t{-1});
  }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(position, next_id, triangles, added);
    for_each_own_array(*this, [&](const auto& /*name*/, Carry /*carry*/, auto& values,
                                  const auto& /*fresh*/) { archive(values); });
  }
};

/// A mesh at rest: rest_position = position, no source known, all vertices projected, ids from 0.
TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles);

/// Gives vertex v, which has a position, an entry by its rule in every array that ends before it, and an id.
/// from: null where it comes from nowhere; it rests where it is then.
void complete_vertex(TriangleMesh& mesh, std::size_t v, const VertexBlend* from);

/// How many vertices have an id below `id`; they come first.
std::size_t vertices_older_than(const TriangleMesh& mesh, std::int64_t id);

/// Takes out the vertices for which `alive` is 0, and triangles {-1, -1, -1}. The rest keeps its order, so
/// ids stay ascending; history.number says where each was.
void remove_dead(std::span<const char> alive, TriangleMesh& mesh, VertexHistory& history);

}  // namespace kappaflow
