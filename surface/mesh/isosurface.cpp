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
#include <optional>
#include <span>

#include "core/errors.h"
#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr double kMostPoints = 2147483648.0;  // 2^31: more is a mistake in the spacing
// [1] Share of the largest |f| of a plane below which a sample counts as this far from zero: a sample of
// exactly zero would put several vertices on the same lattice point. A float has seven digits.
constexpr float kSmallestSample = 1e-6f;
constexpr int kFalsePositions = 40;  // evaluations on an edge at most

/// Plane by plane, so that a plane which two slabs share gets the same values in both.
void move_off_zero(SampledField& samples) {
  const std::size_t plane = static_cast<std::size_t>(samples.dims[0]) * samples.dims[1];
  parallel_for(
      static_cast<std::size_t>(samples.dims[2]),
      [&](std::size_t k) {
        const std::span value = std::span(samples.value).subspan(k * plane, plane);
        float largest = 0;
        for (const float v : value) largest = std::max(largest, std::abs(v));
        const float smallest = kSmallestSample * largest;
        for (float& v : value)
          if (std::abs(v) < smallest) v = v > 0 ? smallest : -smallest;
      },
      1);
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
  if (!(points.prod() <= kMostPoints))
    throw InvalidInput(
        fmt::format("an isosurface at spacing {} m needs {:.3g} lattice points; at most 2^31 are allowed",
                    spacing, points.prod()));
  for (int a = 0; a < 3; ++a) samples.dims[a] = static_cast<int>(points[a]);
  return samples;
}

TriangleMesh extract_isosurface(const Field& field, double spacing, std::size_t points_at_once) {
  if (!(spacing > 0) || !std::isfinite(spacing))
    throw InvalidInput(fmt::format("the spacing of an isosurface is {} m; it must be positive", spacing));
  return extract_isosurface(
      isosurface_lattice(field, spacing), [&](SampledField& samples) { field.sample(samples); },
      points_at_once);
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

struct LatticeVertex {
  Vec3 position, gradient;
  bool exact;
};

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

bool is_exact(const ValueAndGradient& at, double tolerance) {
  return std::abs(at.f) <= tolerance * at.g.norm();
}

/// f = 0 near x between two points of an edge, by one step of Newton's method along the edge, which is enough
/// where f is nearly linear along it.
std::optional<LatticeVertex> newton_on_edge(const Field& field, Vec3 x, const Vec3& from, const Vec3& to,
                                            double tolerance) {
  ValueAndGradient at = field.value_and_gradient(x);
  if (!is_exact(at, tolerance)) {
    const Vec3 edge = to - from;
    const double share = edge.dot(x - from) / edge.squaredNorm() - at.f / at.g.dot(edge);
    if (!(share >= 0 && share <= 1)) return std::nullopt;
    x = from + share * edge;
    at = field.value_and_gradient(x);
  }
  if (!is_exact(at, tolerance)) return std::nullopt;
  return LatticeVertex{x, at.g, true};
}

/// The same by false position, wherever it is between the points; where float and double precision differ
/// about the sign at one end, that end.
LatticeVertex false_position_on_edge(const Field& field, const Vec3& from, const Vec3& to, double tolerance) {
  std::array<Vec3, 2> end{from, to};
  std::array<double, 2> f{field.value_and_gradient(from).f, field.value_and_gradient(to).f};
  Vec3 x = std::abs(f[0]) < std::abs(f[1]) ? from : to;
  ValueAndGradient at = field.value_and_gradient(x);
  for (int i = 0, last = -1; i < kFalsePositions && f[0] * f[1] < 0 && (i == 0 || !is_exact(at, tolerance));
       ++i) {
    x = (f[1] * end[0] - f[0] * end[1]) / (f[1] - f[0]);
    at = field.value_and_gradient(x);
    const int side = (at.f > 0) == (f[0] > 0) ? 0 : 1;
    end[side] = x;
    f[side] = at.f;
    if (side == last) f[1 - side] *= 0.5;
    last = side;
  }
  return {x, at.g, is_exact(at, tolerance)};
}

/// f = 0 between the ends of the lattice's edge that x lies on; x: where linear interpolation puts it, in
/// units of the spacing, from the lattice's origin.
LatticeVertex find_on_edge(const Field& field, const SampledField& lattice, const Vec3& x, double tolerance) {
  const auto [from, to] = edge_of(lattice, x);
  const auto found = newton_on_edge(field, lattice.origin + lattice.spacing * x, from, to, tolerance);
  return found ? *found : false_position_on_edge(field, from, to, tolerance);
}

/// Moves the extractor's vertices, in units of the spacing, onto f = 0 along the lattice's edges.
void place_vertices(const Field& field, vtkPolyData& surface, const SampledField& samples, double tolerance,
                    LocalIsosurface& result) {
  const auto n = static_cast<std::size_t>(surface.GetNumberOfPoints());
  result.position.resize(n);
  result.gradient.resize(n);
  result.exact.resize(n);
  result.at_side.resize(n);
  const Vec3 dims(samples.dims[0] - 1, samples.dims[1] - 1, samples.dims[2] - 1);
  for (std::size_t v = 0; v < n; ++v) {
    Vec3 x;
    surface.GetPoint(static_cast<vtkIdType>(v), x.data());
    result.at_side[v] = (x.array() == 0).any() || (x.array() == dims.array()).any();
    result.position[v] = x + Vec3(0, 0, samples.first_plane);
  }
  parallel_for(
      n,
      [&](std::size_t v) {
        const LatticeVertex found = find_on_edge(field, samples, result.position[v], tolerance);
        result.position[v] = found.position;
        result.gradient[v] = found.gradient;
        result.exact[v] = found.exact;
      },
      16);
}

}  // namespace

void place_on_surface(const Field& field, double spacing, double tolerance, std::span<Vec3> position) {
  const SampledField lattice = isosurface_lattice(field, spacing);
  parallel_for(
      position.size(),
      [&](std::size_t v) {
        position[v] =
            find_on_edge(field, lattice, (position[v] - lattice.origin) / spacing, tolerance).position;
      },
      16);
}

LocalIsosurface local_isosurface(const Field& field, const SampledField& lattice, const LatticeBlock& block,
                                 double tolerance) {
  SampledField samples;
  samples.spacing = lattice.spacing;
  samples.origin = lattice.origin + lattice.spacing * Vec3(block.first[0], block.first[1], 0);
  samples.first_plane = block.first[2];
  for (int a = 0; a < 3; ++a) samples.dims[a] = block.last[a] - block.first[a] + 1;
  field.sample(samples);
  move_off_zero(samples);
  const vtkNew<vtkPolyData> surface = flying_edges(samples);
  LocalIsosurface result;
  place_vertices(field, *surface, samples, tolerance, result);
  for_each_triangle(*surface, [&](const Triangle& triangle) { result.triangles.push_back(triangle); });
  return result;
}

}  // namespace kappaflow
