// Flying Edges (Schroeder, Maynard, Geveci 2015) by VTK. Its marching-cubes table joins ambiguous faces
// consistently and puts no diagonal on a face, so that any lattice of signs gives a closed 2-manifold.
#include "surface/mesh/isosurface.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/errors.h"
#include "core/parallel.h"
#include "surface/mesh/block_isosurface.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/lattice_edges.h"

namespace kappaflow {
namespace {

constexpr double kMostAlongAxis = 536870912.0;  // 2^29 along an axis: differences of indices are int

/// Runs the extractor in lattice units: its vertices are float, and so keep seven digits of a lattice's
/// extent.
vtkNew<vtkPolyData> flying_edges(SampledField& samples) {
  vtkNew<vtkFloatArray> scalars;
  scalars->SetArray(samples.value.data(), static_cast<vtkIdType>(samples.value.size()), 1);
  vtkNew<vtkImageData> image;
  image->SetDimensions(samples.dims.data());
  image->GetPointData()->SetScalars(scalars);
  vtkNew<vtkFlyingEdges3D> filter;
  filter->SetInputData(image);
  filter->ComputeNormalsOff();
  filter->ComputeScalarsOff();
  filter->SetValue(0, 0.0);
  filter->Update();
  vtkNew<vtkPolyData> surface;
  surface->ShallowCopy(filter->GetOutput());
  return surface;
}

template <class Visit>
void for_each_triangle(vtkPolyData& surface, const Visit& visit) {
  const auto cells = vtk::TakeSmartPointer(surface.GetPolys()->NewIterator());
  vtkIdType corners = 0;
  const vtkIdType* v = nullptr;
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
    cells->GetCurrentCell(corners, v);
    visit({static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2])});
  }
}

bool is_whole(const SampledField& lattice, std::span<const LatticeBlock> blocks) {
  return blocks.size() == 1 && blocks[0].first == whole(lattice).first &&
         blocks[0].last == whole(lattice).last;
}

/// Sews the surfaces of slabs together that follow one another and share a plane.
class Seam {
 public:
  void add(vtkPolyData& surface, const SampledField& samples) {
    std::vector<int> index(static_cast<std::size_t>(surface.GetNumberOfPoints()));
    const int last = samples.dims[2] - 1;
    PlaneVertices top;
    for (std::size_t v = 0; v < index.size(); ++v) {
      Vec3 x;
      surface.GetPoint(static_cast<vtkIdType>(v), x.data());
      const std::pair in_plane(x[0], x[1]);
      const auto known = x[2] == 0 ? bottom_.find(in_plane) : bottom_.end();
      index[v] = known != bottom_.end() ? known->second : static_cast<int>(position.size());
      if (known == bottom_.end())
        position.push_back(samples.origin + samples.spacing * Vec3(x[0], x[1], samples.first_plane + x[2]));
      if (x[2] == last) top.emplace(in_plane, index[v]);
    }
    for_each_triangle(surface, [&](const Triangle& t) {
      triangles.push_back({index[static_cast<std::size_t>(t[0])], index[static_cast<std::size_t>(t[1])],
                           index[static_cast<std::size_t>(t[2])]});
    });
    bottom_ = std::move(top);
  }

  std::vector<Vec3> position;
  std::vector<Triangle> triangles;

 private:
  /// By coordinates in the plane, in units of the spacing. Both slabs compute them from the same samples.
  using PlaneVertices = std::map<std::pair<double, double>, int>;

  PlaneVertices bottom_;
};

}  // namespace

SampledField isosurface_lattice(const Field& field, double spacing) {
  const Bounds bounds = field.bounds();
  SampledField samples;
  samples.spacing = spacing;
  if (bounds.empty()) return samples;
  samples.origin = bounds.lower - Vec3::Constant(spacing);
  const Vec3 points = ((bounds.upper - bounds.lower) / spacing).array().ceil() + 3;
  if (!(points.maxCoeff() <= kMostAlongAxis))
    throw InvalidInput(
        fmt::format("an isosurface at spacing {} m needs {:.3g} lattice points along an axis; at most "
                    "2^29 are allowed",
                    spacing, points.maxCoeff()));
  for (int a = 0; a < 3; ++a) samples.dims[a] = static_cast<int>(points[a]);
  return samples;
}

TriangleMesh extract_isosurface(const Field& field, double spacing, std::size_t points_at_once) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw InvalidInput(fmt::format("the spacing of an isosurface is {} m; it must be positive", spacing));
  const SampledField lattice = isosurface_lattice(field, spacing);
  if (lattice.dims[2] == 0) return {};
  const auto sample = [&](SampledField& samples) { field.sample(samples); };
  const std::vector<LatticeBlock> blocks = occupied_blocks(field, lattice);
  if (is_whole(lattice, blocks)) return extract_isosurface(lattice, sample, points_at_once);
  return isosurface_in_blocks(lattice, blocks, sample);
}

TriangleMesh extract_isosurface(const SampledField& lattice, std::span<const LatticeBlock> blocks,
                                const std::function<void(SampledField&)>& sample) {
  if (is_whole(lattice, blocks)) return extract_isosurface(lattice, sample);
  return isosurface_in_blocks(lattice, blocks, sample);
}

TriangleMesh extract_isosurface(const SampledField& lattice, const std::function<void(SampledField&)>& sample,
                                std::size_t points_at_once) {
  SampledField samples = lattice;
  const int planes = samples.dims[2];
  if (planes == 0) return {};
  const std::size_t plane = static_cast<std::size_t>(samples.dims[0]) * samples.dims[1];
  const int at_once = static_cast<int>(std::clamp<std::size_t>(points_at_once / plane, 2, planes));
  Seam seam;
  for (; samples.first_plane < planes - 1; samples.first_plane += at_once - 1) {
    samples.dims[2] = std::min(at_once, planes - samples.first_plane);
    sample(samples);
    move_off_zero(samples);
    const vtkNew<vtkPolyData> surface = flying_edges(samples);
    seam.add(*surface, samples);
  }
  return make_triangle_mesh(std::move(seam.position), std::move(seam.triangles));
}

namespace {

/// The ends of the lattice's edge that x lies on [m]; x: in units of the spacing, from the lattice's origin.
std::pair<Vec3, Vec3> edge_of(const SampledField& lattice, const Vec3& x) {
  Vec3 from = x.array().round();
  Eigen::Index axis = 0;
  (x - from).cwiseAbs().maxCoeff(&axis);
  Vec3 to = from;
  from[axis] = std::floor(x[axis]);
  to[axis] = std::ceil(x[axis]);
  return {lattice.origin + lattice.spacing * from, lattice.origin + lattice.spacing * to};
}

}  // namespace

void place_on_surface(const Field& field, double spacing, double tolerance, std::span<Vec3> position) {
  const SampledField lattice = isosurface_lattice(field, spacing);
  parallel_for(
      position.size(),
      [&](std::size_t v) {
        const Vec3 x = (position[v] - lattice.origin) / spacing;
        const auto [from, to] = edge_of(lattice, x);
        position[v] = find_on_edge(field, lattice.origin + spacing * x, from, to, tolerance).position;
      },
      16);
}

}  // namespace kappaflow
