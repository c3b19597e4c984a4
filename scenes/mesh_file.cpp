#include "scenes/mesh_file.h"

#include <fmt/format.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolygon.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/read_file.h"
#include "core/solids.h"
#include "core/text_scanner.h"
#include "core/triangle_geometry.h"
#include "scenes/mesh_parsers.h"
#include "scenes/scene.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

/// Twice the area of a triangle over the square of its longest edge below which it has no usable normal.
constexpr double kDegenerate = 1e-9;

/// For every point the first one with the same coordinates, which must be finite.
std::vector<int> first_equal_points(const std::vector<Vec3>& points) {
  std::vector<int> order(points.size()), first(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int p) { return std::tuple(points[p].x(), points[p].y(), points[p].z(), p); };
  std::sort(order.begin(), order.end(), [&](int p, int q) { return key(p) < key(q); });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && points[order[k]] == points[order[k - 1]] ? first[order[k - 1]] : order[k];
  return first;
}

/// Cuts a polygon, which need not be convex, into triangles.
void add_triangles(const std::vector<Vec3>& points, const std::vector<int>& polygon,
                   std::vector<Triangle>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  vtkNew<vtkPolygon> shape;
  for (const int p : polygon) shape->GetPoints()->InsertNextPoint(points[p].data());
  shape->GetPointIds()->SetNumberOfIds(static_cast<vtkIdType>(polygon.size()));
  std::iota(shape->GetPointIds()->begin(), shape->GetPointIds()->end(), vtkIdType{0});
  vtkNew<vtkIdList> corners;
  if (!shape->Triangulate(corners))
    throw InvalidInput(
        fmt::format("has a polygon of {} corners that cannot be cut into triangles", polygon.size()));
  for (vtkIdType k = 0; k + 2 < corners->GetNumberOfIds(); k += 3)
    triangles.push_back(
        {polygon[corners->GetId(k)], polygon[corners->GetId(k + 1)], polygon[corners->GetId(k + 2)]});
}

/// Drops the points that no triangle uses.
void keep_used_points(TriangleSurface& surface) {
  std::vector<int> kept(surface.vertices.size(), -1);
  std::vector<Vec3> vertices;
  for (Triangle& triangle : surface.triangles)
    for (int& corner : triangle) {
      if (kept[corner] < 0) {
        kept[corner] = static_cast<int>(vertices.size());
        vertices.push_back(surface.vertices[corner]);
      }
      corner = kept[corner];
    }
  surface.vertices = std::move(vertices);
}

void check_areas(const TriangleSurface& surface) {
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 &a = surface.vertices[i], &b = surface.vertices[j], &c = surface.vertices[k];
    if (!(twice_area_vector(a, b, c).norm() > kDegenerate * longest_edge_squared(a, b, c)))
      throw InvalidInput(
          fmt::format("has a triangle without area at ({:.6g}, {:.6g}, {:.6g})", a.x(), a.y(), a.z()));
  }
}

TriangleSurface closed_surface(PolygonMesh mesh) {
  TriangleSurface surface = triangle_surface(std::move(mesh));
  if (surface.triangles.empty()) throw InvalidInput("has no triangles");
  check_areas(surface);
  mesh_topology(surface.vertices, surface.triangles);  // throws where it is not closed
  const double volume = area_and_volume(surface.vertices, surface.triangles).volume;
  if (volume == 0) throw InvalidInput("encloses no volume");
  if (volume < 0)
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  check_crossings(surface);
  solids_of(surface);  // throws where a piece faces inward that is no cavity
  return surface;
}

/// The format that the name says.
auto parser_for(const std::filesystem::path& file) {
  const std::string ending = lower_case(file.extension().string());
  const auto parser = ending == ".stl"   ? parse_stl
                      : ending == ".obj" ? parse_obj
                      : ending == ".ply" ? parse_ply
                                         : nullptr;
  if (!parser) throw InvalidInput("has none of the known endings");
  return parser;
}

ClosedMesh closed_mesh(const std::filesystem::path& file) {
  const auto parse = parser_for(file);
  std::error_code ignored;  // a file that cannot be examined is not a regular one
  if (!std::filesystem::is_regular_file(file, ignored))
    throw InvalidInput("is not there, or no regular file");
  ClosedMesh mesh{read_file(file), {}};
  mesh.surface = closed_surface(parse(mesh.bytes));
  return mesh;
}

}  // namespace

TriangleSurface triangle_surface(PolygonMesh mesh) {
  for (const Vec3& x : mesh.points)
    if (!x.allFinite()) throw InvalidInput("has a point that is not finite");
  TriangleSurface surface;
  for (const std::vector<int>& polygon : mesh.polygons)
    add_triangles(mesh.points, polygon, surface.triangles);
  const std::vector<int> first = first_equal_points(mesh.points);
  for (Triangle& triangle : surface.triangles)
    for (int& corner : triangle) corner = first[corner];
  std::erase_if(surface.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  surface.vertices = std::move(mesh.points);
  keep_used_points(surface);
  return surface;
}

ClosedMesh read_closed_mesh(const std::filesystem::path& file, const SourcePosition& where) {
  const auto located = [&](const std::string& found) {
    return InvalidInput(
        where, fmt::format("mesh \"{}\" {}; allowed: the closed surface of a solid as .stl, .obj or .ply",
                           file.string(), found));
  };
  try {
    return closed_mesh(file);
  } catch (const IoError&) {
    throw located("cannot be read");
  } catch (const TopologyError& error) {
    throw located(fmt::format("is no solid: {}", error.what()));
  } catch (const InvalidInput& error) {
    throw located(error.what());
  }
}

const ClosedMesh& MeshFiles::read(const MeshShape& mesh, const SourcePosition& where) {
  const auto found = known_.find(mesh.file);
  if (found != known_.end()) return found->second;
  return known_.emplace(mesh.file, read_closed_mesh(mesh.file, where)).first->second;
}

TriangleSurface MeshFiles::surface(const MeshShape& mesh, const SourcePosition& where) {
  TriangleSurface surface = read(mesh, where).surface;
  for (Vec3& x : surface.vertices) x = mesh.scale * x + mesh.translation;
  return surface;
}

}  // namespace kappaflow
