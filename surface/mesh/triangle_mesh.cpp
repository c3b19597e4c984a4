#include "surface/mesh/triangle_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "core/errors.h"

namespace kappaflow {
namespace {

/// The added array of that name; throws InvalidInput where there is none of type T.
template <class T, class Mesh>
auto& added_values(Mesh& mesh, std::string_view name) {
  std::string names;
  for (auto& array : mesh.added) {
    if (auto* const data = std::get_if<VertexArray::Of<T>>(&array.data); data && array.name == name)
      return data->values;
    names += (names.empty() ? "" : ", ") + array.name;
  }
  throw InvalidInput(fmt::format("the mesh has no added array '{}' of this type; added are: {}", name,
                                 names.empty() ? "none" : names));
}

}  // namespace

template <class T>
std::span<T> TriangleMesh::add_array(std::string_view name, Carry carry, const T& fresh) {
  for_each_array(*this, [&](std::string_view taken, Carry, const auto&, const auto&) {
    if (taken == name) throw InvalidInput(fmt::format("the mesh has an array '{}' already", name));
  });
  const bool blends = !std::is_integral_v<T>;
  if (carry == Carry::interpolate && !blends)
    throw InvalidInput(fmt::format("the array '{}' holds whole numbers, which are not interpolated", name));
  added.push_back(
      {std::string(name), carry, VertexArray::Of<T>{std::vector<T>(vertex_count(), fresh), fresh}});
  return array<T>(name);
}

template <class T>
std::span<T> TriangleMesh::array(std::string_view name) {
  return added_values<T>(*this, name);
}

template <class T>
std::span<const T> TriangleMesh::array(std::string_view name) const {
  return added_values<T>(*this, name);
}

template std::span<double> TriangleMesh::add_array(std::string_view, Carry, const double&);
template std::span<Vec3> TriangleMesh::add_array(std::string_view, Carry, const Vec3&);
template std::span<int> TriangleMesh::add_array(std::string_view, Carry, const int&);
template std::span<double> TriangleMesh::array(std::string_view);
template std::span<Vec3> TriangleMesh::array(std::string_view);
template std::span<int> TriangleMesh::array(std::string_view);
template std::span<const double> TriangleMesh::array(std::string_view) const;
template std::span<const Vec3> TriangleMesh::array(std::string_view) const;
template std::span<const int> TriangleMesh::array(std::string_view) const;

TriangleMesh make_triangle_mesh(std::vector<Vec3> position, std::vector<Triangle> triangles) {
  TriangleMesh mesh;
  const std::size_t vertices = position.size();
  TriangleMesh::for_each_own_array(mesh, [&](std::string_view, Carry, auto& values, const auto& fresh) {
    values.assign(vertices, fresh);
  });
  mesh.rest_position = position;
  std::iota(mesh.id.begin(), mesh.id.end(), std::int64_t{0});
  mesh.next_id = static_cast<std::int64_t>(vertices);
  mesh.position = std::move(position);
  mesh.triangles = std::move(triangles);
  return mesh;
}

void complete_vertex(TriangleMesh& mesh, std::size_t v, const VertexBlend* from) {
  TriangleMesh::for_each_array(mesh, [&](std::string_view, Carry carry, auto& values, const auto& fresh) {
    if (values.size() == v) values.push_back(carried(values, carry, fresh, from));
  });
  if (from == nullptr) mesh.rest_position[v] = mesh.position[v];
  mesh.id[v] = mesh.next_id++;
}

std::size_t vertices_older_than(const TriangleMesh& mesh, std::int64_t id) {
  return static_cast<std::size_t>(std::ranges::lower_bound(mesh.id, id) - mesh.id.begin());
}

void remove_dead(std::span<const char> alive, TriangleMesh& mesh, VertexHistory& history) {
  history.number.clear();
  std::vector<int> renumbered(alive.size());
  for (std::size_t v = 0; v < alive.size(); ++v) {
    renumbered[v] = static_cast<int>(history.number.size());
    if (alive[v]) history.number.push_back(static_cast<int>(v));
  }
  history.keep(mesh.position);
  TriangleMesh::for_each_array(
      mesh, [&](std::string_view, Carry, auto& values, const auto& /*fresh*/) { history.keep(values); });
  std::erase(mesh.triangles, kRemovedTriangle);
  for (Triangle& triangle : mesh.triangles)
    for (int& v : triangle) v = renumbered[v];
}

}  // namespace kappaflow
