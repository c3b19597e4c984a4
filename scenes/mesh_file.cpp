#include "scenes/mesh_file.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCleanPolyData.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkPLYReader.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSmartPointer.h>
#include <vtkTriangleFilter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

/// Twice the area of a triangle over the square of its longest edge below which it has no usable normal.
constexpr double kDegenerate = 1e-9;

/// Keeps what VTK would print, so that a mistake in a file is reported as one line and by us.
class SilentWindow : public vtkOutputWindow {
 public:
  static SilentWindow* New();
  vtkTypeMacro(SilentWindow, vtkOutputWindow) void DisplayText(const char*) override { reported_ = true; }
  bool reported() const { return reported_; }

 private:
  bool reported_ = false;
};
vtkStandardNewMacro(SilentWindow)

    /// Puts a SilentWindow in place while it lives.
    class CaughtReports {
 public:
  CaughtReports() : before_(vtkOutputWindow::GetInstance()) { vtkOutputWindow::SetInstance(window_); }
  ~CaughtReports() { vtkOutputWindow::SetInstance(before_); }
  CaughtReports(const CaughtReports&) = delete;
  CaughtReports& operator=(const CaughtReports&) = delete;
  bool any() const { return window_->reported(); }

 private:
  vtkNew<SilentWindow> window_;
  vtkSmartPointer<vtkOutputWindow> before_;
};

template <class Reader>
vtkSmartPointer<vtkPolyData> read_with(const std::string& file) {
  vtkNew<Reader> reader;
  reader->SetFileName(file.c_str());
  vtkNew<vtkTriangleFilter> triangles;  // cuts polygons and strips
  triangles->SetInputConnection(reader->GetOutputPort());
  triangles->PassLinesOff();
  triangles->PassVertsOff();
  vtkNew<vtkCleanPolyData> clean;  // merges points with equal coordinates, drops unused ones
  clean->SetInputConnection(triangles->GetOutputPort());
  clean->SetTolerance(0);
  clean->ConvertPolysToLinesOff();
  clean->Update();
  return clean->GetOutput();
}

/// The file's polygons, or null where its name has no known ending.
vtkSmartPointer<vtkPolyData> read_polygons(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".stl") return read_with<vtkSTLReader>(file.string());
  if (ending == ".obj") return read_with<vtkOBJReader>(file.string());
  if (ending == ".ply") return read_with<vtkPLYReader>(file.string());
  return nullptr;
}

TriangleSurface triangle_surface(vtkPolyData& polygons) {
  TriangleSurface surface;
  surface.vertices.resize(static_cast<std::size_t>(polygons.GetNumberOfPoints()));
  for (std::size_t v = 0; v < surface.vertices.size(); ++v)
    polygons.GetPoint(static_cast<vtkIdType>(v), surface.vertices[v].data());
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  polygons.GetPolys()->InitTraversal();
  while (polygons.GetPolys()->GetNextCell(size, corners)) {
    if (size != 3) continue;  // a polygon whose points are equal collapses to less
    surface.triangles.push_back(
        {static_cast<int>(corners[0]), static_cast<int>(corners[1]), static_cast<int>(corners[2])});
  }
  return surface;
}

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return !((b - a).cross(c - a).norm() > kDegenerate * longest);
}

/// Why the surface cannot be a wall; empty: it can. Turns it outward.
std::string make_outward(TriangleSurface& surface) {
  if (surface.triangles.empty()) return "has no triangles";
  for (const Vec3& x : surface.vertices)
    if (!x.allFinite()) return "has a point that is not finite";
  for (const auto& [a, b, c] : surface.triangles)
    if (const Vec3& x = surface.vertices[a]; is_degenerate(x, surface.vertices[b], surface.vertices[c]))
      return fmt::format("has a triangle without area at ({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z());
  try {
    mesh_topology(surface.vertices, surface.triangles);
  } catch (const TopologyError& error) {
    return fmt::format("is not closed, manifold and consistently oriented: {}", error.what());
  }
  const double volume = area_and_volume(surface.vertices, surface.triangles).volume;
  if (volume == 0) return "encloses no volume";
  if (volume < 0)
    for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return {};
}

}  // namespace

TriangleSurface read_closed_mesh(const std::filesystem::path& file, const SourcePosition& where) {
  const auto fail = [&](const std::string& found) {
    throw InvalidInput(
        where, fmt::format("mesh \"{}\" {}; allowed: the closed surface of a solid as .stl, .obj or .ply",
                           file.string(), found));
  };
  std::error_code ignored;  // a file that cannot be examined is not a regular one
  if (!std::filesystem::is_regular_file(file, ignored)) fail("is not there or no regular file");
  const CaughtReports reports;
  const vtkSmartPointer<vtkPolyData> polygons = read_polygons(file);
  if (!polygons) fail("has none of the known endings");
  if (reports.any()) fail("is damaged or not what its ending says");
  TriangleSurface surface = triangle_surface(*polygons);
  if (const std::string reason = make_outward(surface); !reason.empty()) fail(reason);
  return surface;
}

}  // namespace kappaflow
