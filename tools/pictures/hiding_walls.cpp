#include "tools/pictures/hiding_walls.h"

#include <vtkCellArray.h>
#include <vtkFeatureEdges.h>
#include <vtkNew.h>
#include <vtkStaticCellLocator.h>

#include <map>
#include <numeric>
#include <tuple>

#include "core/connectivity.h"
#include "core/triangle_geometry.h"
#include "tools/io/surface_file.h"

namespace kappaflow {
namespace {

constexpr vtkIdType kRays = 500;
constexpr double kHidden = 0.1;   // share of the rays that a face stops before it counts as in the way
constexpr double kSharp = 0.766;  // cosine between triangles of one face: 40 degrees
constexpr double kStep = 1e-6;    // of the scene's size, from one hit to the next
constexpr int kMostHits = 20;     // of a ray

/// The triangles over vertices of which no two are in one place.
std::vector<Triangle> joined(vtkPolyData& walls, std::vector<Triangle> triangles) {
  std::map<std::tuple<double, double, double>, int> vertex_at;
  for (Triangle& triangle : triangles)
    for (int& v : triangle) {
      const Vec3 x(walls.GetPoint(v));
      const int next = static_cast<int>(vertex_at.size());
      v = vertex_at.try_emplace({x[0], x[1], x[2]}, next).first->second;
    }
  return triangles;
}

/// The face that each triangle belongs to, named by one of its triangles.
std::vector<int> smooth_faces(vtkPolyData& walls) {
  const std::vector<Triangle> triangles = triangles_of(walls);
  std::vector<Vec3> normal;
  normal.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles)
    normal.push_back(
        twice_area_vector(Vec3(walls.GetPoint(a)), Vec3(walls.GetPoint(b)), Vec3(walls.GetPoint(c)))
            .normalized());
  std::vector<int> face(triangles.size());
  std::iota(face.begin(), face.end(), 0);
  const auto root = [&](int t) {
    while (face[t] != t) t = face[t] = face[face[t]];
    return t;
  };
  const EdgeSides edges(joined(walls, triangles));
  for (std::size_t e = 0; e < edges.edges(); ++e) {
    const int first = edges.of(e).front() / 3;
    for (const int h : edges.of(e).subspan(1))
      if (normal[first].dot(normal[h / 3]) > kSharp) face[root(h / 3)] = root(first);
  }
  for (int t = 0; t < static_cast<int>(face.size()); ++t) face[t] = root(t);
  return face;
}

/// Calls visit with each triangle on the way from x, of the first some.
template <class Visit>
void for_each_hit(vtkStaticCellLocator& walls, Vec3 from, const Vec3& to, double step, const Visit& visit) {
  const Vec3 direction = (to - from).normalized();
  for (int hit = 0; hit < kMostHits; ++hit) {
    double along = 0;
    Vec3 at, coordinates;
    int part = 0;
    vtkIdType triangle = -1;
    if (walls.IntersectWithLine(from.data(), to.data(), 0, along, at.data(), coordinates.data(), part,
                                triangle) == 0)
      return;
    visit(triangle);
    from = at + step * direction;
  }
}

/// The share of the liquid's vertices whose way to the viewer each face stops.
std::vector<double> stopped_by_faces(vtkStaticCellLocator& walls, const std::vector<int>& face,
                                     vtkPolyData& liquid, double size, const Vec3& to_viewer) {
  std::vector<int> stopped(face.size()), last_ray(face.size(), -1);
  const vtkIdType vertices = liquid.GetNumberOfPoints();
  int rays = 0;
  for (vtkIdType v = 0; v < vertices; v += 1 + vertices / kRays, ++rays) {
    const Vec3 x(liquid.GetPoint(v));
    for_each_hit(walls, x, x + 2 * size * to_viewer, kStep * size, [&](vtkIdType triangle) {
      const int f = face[triangle];
      if (last_ray[f] != rays) ++stopped[f];
      last_ray[f] = rays;
    });
  }
  std::vector<double> share;
  share.reserve(stopped.size());
  for (const int count : stopped) share.push_back(static_cast<double>(count) / rays);
  return share;
}

}  // namespace

std::vector<std::uint32_t> hiding_triangles(vtkPolyData& walls, vtkPolyData& liquid,
                                            std::span<const Vec3> viewers) {
  std::vector<std::uint32_t> hiding(static_cast<std::size_t>(walls.GetNumberOfCells()));
  if (hiding.empty() || liquid.GetNumberOfPoints() == 0) return hiding;
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(&walls);
  locator->BuildLocator();
  const std::vector<int> face = smooth_faces(walls);
  const double size = walls.GetLength() + liquid.GetLength();
  for (std::size_t d = 0; d < viewers.size(); ++d) {
    const std::vector<double> share = stopped_by_faces(*locator, face, liquid, size, viewers[d].normalized());
    for (std::size_t t = 0; t < hiding.size(); ++t)
      hiding[t] |= static_cast<std::uint32_t>(share[face[t]] > kHidden) << d;
  }
  return hiding;
}

vtkSmartPointer<vtkPolyData> part_of(vtkPolyData& walls, std::span<const std::uint32_t> hiding, bool hides) {
  vtkNew<vtkCellArray> triangles;
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < walls.GetNumberOfCells(); ++t) {
    if ((hiding[t] != 0) != hides) continue;
    walls.GetCellPoints(t, corners);
    triangles->InsertNextCell(corners);
  }
  auto part = vtkSmartPointer<vtkPolyData>::New();
  part->SetPoints(walls.GetPoints());
  part->SetPolys(triangles);
  return part;
}

vtkSmartPointer<vtkPolyData> sharp_edges(vtkPolyData& walls) {
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputData(&walls);
  edges->ManifoldEdgesOff();
  edges->NonManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  return edges->GetOutput();
}

}  // namespace kappaflow
