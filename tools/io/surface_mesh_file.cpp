#include "tools/io/surface_mesh_file.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/connectivity.h"
#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "scenes/mesh_file.h"
#include "scenes/mesh_parsers.h"
#include "surface/mesh/mesh_measures.h"
#include "tools/io/legacy_vtk.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {
namespace {

/// Polygons and the instant that they are of.
struct TimedPolygons {
  PolygonMesh mesh;
  std::optional<double> time{};
};

TimedPolygons polygons_of(VtkPolygons data) {
  TimedPolygons result{{std::move(data.points.position), {}}, time_in(data.points.fields)};
  std::size_t begin = 0;
  for (const std::size_t end : data.polygons.end) {
    if (end - begin > 2)
      result.mesh.polygons.emplace_back(data.polygons.corner.begin() + static_cast<std::ptrdiff_t>(begin),
                                        data.polygons.corner.begin() + static_cast<std::ptrdiff_t>(end));
    begin = end;
  }
  return result;
}

TimedPolygons read_polygons(const std::filesystem::path& file) {
  const std::string kind = lower_case(file.extension().string());
  if (kind != ".obj" && kind != ".ply" && kind != ".stl" && kind != ".vtp" && kind != ".vtk")
    throw InvalidInput({file.string()}, "unknown kind of mesh; expected .obj, .ply, .stl, .vtp or .vtk");
  const std::string bytes = read_file(file);
  try {
    if (kind == ".vtp") return polygons_of(parse_vtk_polygons(bytes));
    if (kind == ".vtk") return polygons_of(parse_legacy_polygons(bytes));
    return {kind == ".obj" ? parse_obj(bytes) : kind == ".ply" ? parse_ply(bytes) : parse_stl(bytes)};
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

/// A vertex at the end of an edge that runs more often in one direction than in the other; -1: none.
int open_vertex(std::span<const Triangle> triangles) {
  const Boundary boundary = boundary_of(triangles);
  if (!boundary.pinched.empty()) return boundary.pinched.front();
  return boundary.loops.empty() ? -1 : boundary.loops.front().front();
}

TriangleSurface closed_surface(PolygonMesh mesh) {
  constexpr std::size_t kLeastTriangles = 4;
  TriangleSurface surface = triangle_surface(std::move(mesh));
  if (surface.triangles.size() < kLeastTriangles)
    throw InvalidInput(fmt::format("has {} triangles; expected a closed surface of {} or more",
                                   surface.triangles.size(), kLeastTriangles));
  if (const int open = open_vertex(surface.triangles); open >= 0)
    throw InvalidInput(fmt::format(
        "is not closed: an edge at ({:.6g}) has no triangle on its other side, or one that is turned the "
        "other way",
        fmt::join(surface.vertices[open], ", ")));
  const double volume = area_and_volume(surface.vertices, surface.triangles).volume;
  if (!std::isfinite(volume) || volume == 0) throw InvalidInput("encloses no volume");
  if (volume < 0)
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

}  // namespace

MeshFrame read_mesh_frame(const std::filesystem::path& file) {
  TimedPolygons polygons = read_polygons(file);
  try {
    if (polygons.time && !std::isfinite(*polygons.time))
      throw InvalidInput(fmt::format("its time is {} s; it must be finite", *polygons.time));
    return {closed_surface(std::move(polygons.mesh)), polygons.time};
  } catch (const InvalidInput& error) {
    throw InvalidInput({file.string()}, error.what());
  }
}

}  // namespace kappaflow
