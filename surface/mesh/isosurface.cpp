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

#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr double kMostPoints = 2147483648.0;  // 2^31
// Share of the largest |f| below which a sample counts as this far from zero: a sample of exactly zero would
// put several vertices on the same lattice point.
constexpr float kSmallestSample = 1e-6f;

/// The lattice over the field's bounds, padded so that its outermost points have f < 0.
SampledField lattice(const Field& field, double spacing) {
  const Bounds bounds = field.bounds();
  SampledField samples;
  samples.spacing = spacing;
  if (bounds.empty()) return samples;
  samples.origin = bounds.lower - Vec3::Constant(spacing);
  const Vec3 points = ((bounds.upper - bounds.lower) / spacing).array().ceil() + 3;
  if (!(points.prod() <= kMostPoints))
    throw InvalidInput(
        fmt::format("an isosurface at spacing {} m needs {:.3g} lattice points; at most 2^31 are allowed",
                    spacing, points.prod()));
  for (int a = 0; a < 3; ++a) samples.dims[a] = static_cast<int>(points[a]);
  return samples;
}

void move_off_zero(std::vector<float>& value) {
  const float largest = parallel_max(
      value.size(), 0.0f, [&](std::size_t i) { return std::abs(value[i]); }, 65536);
  const float smallest = kSmallestSample * largest;
  parallel_for(
      value.size(),
      [&](std::size_t i) {
        if (std::abs(value[i]) < smallest) value[i] = value[i] > 0 ? smallest : -smallest;
      },
      65536);
}

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

std::vector<Vec3> positions(vtkPolyData& surface, const SampledField& samples) {
  std::vector<Vec3> position(static_cast<std::size_t>(surface.GetNumberOfPoints()));
  for (std::size_t v = 0; v < position.size(); ++v) {
    surface.GetPoint(static_cast<vtkIdType>(v), position[v].data());
    position[v] = samples.origin + samples.spacing * position[v];
  }
  return position;
}

std::vector<Triangle> triangles(vtkPolyData& surface) {
  std::vector<Triangle> triangles;
  triangles.reserve(static_cast<std::size_t>(surface.GetNumberOfPolys()));
  const auto cells = vtk::TakeSmartPointer(surface.GetPolys()->NewIterator());
  vtkIdType corners = 0;
  const vtkIdType* v = nullptr;
  for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
    cells->GetCurrentCell(corners, v);
    triangles.push_back({static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2])});
  }
  return triangles;
}

}  // namespace

TriangleMesh extract_isosurface(const Field& field, double spacing) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw InvalidInput(fmt::format("the spacing of an isosurface is {} m; it must be positive", spacing));
  SampledField samples = lattice(field, spacing);
  if (samples.dims[0] == 0) return {};
  field.sample(samples);
  move_off_zero(samples.value);
  const vtkNew<vtkPolyData> surface = flying_edges(samples);
  return make_triangle_mesh(positions(*surface, samples), triangles(*surface));
}

}  // namespace kappaflow
