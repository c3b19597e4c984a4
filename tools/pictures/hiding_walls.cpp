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

namespace kappaflow {
namespace {

constexpr vtkIdType kRays = 500;
constexpr double kHidden = 0.1;   // share of the rays that a face stops before it counts as in the way
constexpr double kSharp = 0.766;  // cosine between triangles of one face: 40 degrees
constexpr double kStep = 1e-6;    // of the scene's size, from one hit to the next
constexpr int kMostHits = 20;     // of a ray

/// Triangles over vertices of which no two are in one place.
std::vector<Triangle> joined_triangles(vtkPolyData& walls) {
  std::map<std::tuple<double, double, double>, int> vertex_at;
  std::vector<Triangle> triangles;
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < walls.GetNumberOfCells(); ++t) {
    walls.GetCellPoints(t, corners);
    Triangle triangle{};
    for (int c = 0; c < 3; ++c) {
      const Vec3 x(walls.GetPoint(corners->GetId(c)));
      const int next = static_cast<int>(vertex_at.size());
      triangle[static_cast<std::size_t>(c)] = vertex_at.try_emplace({x[0], x[1], x[2]}, next).first->second;
    }
    triangles.push_back(triangle);
  }
  return triangles;
}

std::vector<Vec3> triangle_normals(vtkPolyData& walls) {
  std::vector<Vec3> normals;
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < walls.GetNumberOfCells(); ++t) {
    walls.GetCellPoints(t, corners);
    std::array<Vec3, 3> x;
    for (int c = 0; c < 3; ++c) x[static_cast<std::size_t>(c)] = Vec3(walls.GetPoint(corners->GetId(c)));
    normals.push_back(twice_area_vector(x[0], x[1], x[2]).normalized());
  }
  return normals;
}

/// The face that each triangle belongs to, named by one of its triangles.
std::vector<int> smooth_faces(vtkPolyData& walls) {
  const std::vector<Triangle> triangles = joined_triangles(walls);
  const std::vector<Vec3> normal = triangle_normals(walls);
  std::vector<int> face(triangles.size());
  std::iota(face.begin(), face.end(), 0);
  const auto root = [&](int t) {
    while (face[t] != t) t = face[t] = face[face[t]];
    return t;
  };
  const EdgeSides edges(triangles);
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

}  // namespace

std::vector<char> hiding_triangles(vtkPolyData& walls, vtkPolyData& liquid, const Vec3& from) {
  std::vector<char> hiding(static_cast<std::size_t>(walls.GetNumberOfCells()));
  const vtkIdType vertices = liquid.GetNumberOfPoints();
  if (hiding.empty() || vertices == 0) return hiding;
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(&walls);
  locator->BuildLocator();
  const std::vector<int> face = smooth_faces(walls);
  std::vector<int> stopped(hiding.size()), last_ray(hiding.size(), -1);  // by face
  const double size = walls.GetLength() + liquid.GetLength();
  int rays = 0;
  for (vtkIdType v = 0; v < vertices; v += 1 + vertices / kRays, ++rays) {
    const Vec3 x(liquid.GetPoint(v));
    for_each_hit(*locator, x, x + 2 * size * from.normalized(), kStep * size, [&](vtkIdType triangle) {
      const int f = face[triangle];
      if (last_ray[f] != rays) ++stopped[f];
      last_ray[f] = rays;
    });
  }
  for (std::size_t t = 0; t < hiding.size(); ++t) hiding[t] = stopped[face[t]] > kHidden * rays;
  return hiding;
}

vtkSmartPointer<vtkPolyData> part_of(vtkPolyData& walls, std::span<const char> flag, char value) {
  vtkNew<vtkCellArray> triangles;
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < walls.GetNumberOfCells(); ++t) {
    if (flag[t] != value) continue;
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
