#include "tools/pictures/page_surfaces.h"

#include <fmt/format.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/quantile.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/surface_arrays.h"
#include "tools/runs/frame_rate.h"
#include "tools/runs/progress.h"

namespace kappaflow {
namespace {

constexpr const char* kColoured[] = {"material_slip", "mean_curvature", "confidence", kEmissionTimeArray};

/// What rounding leaves of zero at most, as of the slip of `material` against itself.
constexpr double kRounding = 1e-12;

/// A colour's array, and the ends of its range in each surface so far, method by method in each frame.
struct ColouredArray {
  const char* array;
  std::vector<double> lower{}, upper{};
  bool everywhere = true;
};

void widen(Bounds& box, const Vec3& x) {
  box.lower = box.lower.cwiseMin(x);
  box.upper = box.upper.cwiseMax(x);
}

vtkDataArray& rest_of(vtkPolyData& surface) {
  return array_in(*surface.GetPointData(), "rest_position", 3, surface.GetNumberOfPoints());
}

void widen(PageRanges& ranges, std::vector<ColouredArray>& fields, vtkPolyData& surface) {
  vtkDataArray& rest = rest_of(surface);
  for (vtkIdType v = 0; v < surface.GetNumberOfPoints(); ++v) {
    widen(ranges.box, Vec3(surface.GetPoint(v)));
    widen(ranges.rest, Vec3(rest.GetTuple3(v)));
  }
  for (ColouredArray& field : fields) {
    field.everywhere = field.everywhere && surface.GetPointData()->HasArray(field.array) != 0;
    if (!field.everywhere) continue;
    const auto [lower, upper] = value_range(surface, field.array);
    field.lower.push_back(lower);
    field.upper.push_back(upper);
  }
}

/// The median over the frames, of that method for which it is the largest.
double typical_end(const std::vector<double>& ends, std::size_t methods) {
  double result = -HUGE_VAL;
  for (std::size_t m = 0; m < methods; ++m) {
    std::vector<double> of_method;
    for (std::size_t i = m; i < ends.size(); i += methods) of_method.push_back(ends[i]);
    result = std::max(result, quantile(of_method, 0.5));
  }
  return result;
}

/// A frame in which values are far from what they are else, as when liquid hits a wall, does not count; of
/// times all do, for they go on.
ValueRange typical_range(const ColouredArray& field, std::size_t methods) {
  if (field.array == std::string_view(kEmissionTimeArray))
    return {std::ranges::min(field.lower), std::ranges::max(field.upper)};
  std::vector<double> lower = field.lower;
  for (double& end : lower) end = -end;
  return {-typical_end(lower, methods), typical_end(field.upper, methods)};
}

std::vector<Colouring> colours_of(const std::vector<ColouredArray>& fields, std::size_t methods,
                                  vtkPolyData& example) {
  std::vector<Colouring> colours;
  for (const ColouredArray& field : fields) {
    if (!field.everywhere) continue;
    const ValueRange range = rounded(typical_range(field, methods));
    if (std::max(-range[0], range[1]) > kRounding) colours.push_back(colouring(example, field.array, range));
  }
  return colours;
}

// 0 to 254, so that 0 has a number of its own.
std::uint16_t signed_byte(double x) {
  return static_cast<std::uint16_t>(std::lround(127 * std::clamp(x, -1.0, 1.0)) + 127);
}

Vec2 on_octahedron(const Vec3& normal) {
  const double sum = normal.lpNorm<1>();
  if (!(sum > 0)) return {0, 0};
  const Vec3 n = normal / sum;
  if (n.z() >= 0) return n.head<2>();
  return {std::copysign(1 - std::abs(n.y()), n.x()), std::copysign(1 - std::abs(n.x()), n.y())};
}

std::uint16_t colour_byte(double value, ValueRange range) {
  if (!std::isfinite(value)) return 0;
  return static_cast<std::uint16_t>(
      std::lround(255 * std::clamp((value - range[0]) / (range[1] - range[0]), 0.0, 1.0)));
}

void add_places(QuantisedSurface& result, vtkDataArray& points, const Bounds& box) {
  for (int a = 0; a < 3; ++a) {
    PackedComponent& component = result.components.emplace_back(PackedComponent{2, {}});
    for (vtkIdType v = 0; v < points.GetNumberOfTuples(); ++v)
      component.value.push_back(quantised(points.GetComponent(v, a), box.lower[a], box.upper[a]));
  }
}

void add_normals(QuantisedSurface& result, vtkDataArray& normals) {
  PackedComponent first, second;
  for (vtkIdType v = 0; v < normals.GetNumberOfTuples(); ++v) {
    const Vec2 place = on_octahedron(Vec3(normals.GetTuple3(v)));
    first.value.push_back(signed_byte(place.x()));
    second.value.push_back(signed_byte(place.y()));
  }
  result.components.push_back(std::move(first));
  result.components.push_back(std::move(second));
}

void add_colour(QuantisedSurface& result, vtkDataArray& values, ValueRange range) {
  PackedComponent& component = result.components.emplace_back();
  for (vtkIdType v = 0; v < values.GetNumberOfTuples(); ++v)
    component.value.push_back(colour_byte(values.GetComponent(v, 0), range));
}

}  // namespace

std::uint16_t quantised(double x, double lower, double upper) {
  const double share = upper > lower ? std::clamp((x - lower) / (upper - lower), 0.0, 1.0) : 0;
  return static_cast<std::uint16_t>(std::lround(65535 * share));
}

PageRanges page_ranges(const RunFrames& frames) {
  constexpr double kFar = HUGE_VAL;
  const Bounds nothing{Vec3::Constant(kFar), Vec3::Constant(-kFar)};
  PageRanges ranges{nothing, nothing, {}, {}, {}, {}, {}};
  if (is_fed(frames)) ranges.emission.emplace(frames, frames.count() - 1);
  std::vector<ColouredArray> fields;
  for (const char* array : kColoured) fields.push_back({array});
  std::vector<vtkSmartPointer<vtkPolyData>> surfaces;
  WorkProgress progress("reading frame", frames.count());
  for (int frame = 0; frame < frames.count(); ++frame) {
    progress.show(frame);
    surfaces.clear();
    for (const std::string& method : frames.methods())
      surfaces.push_back(page_surface(frames, ranges, method, frame));
    for (const auto& surface : surfaces) widen(ranges, fields, *surface);
    const std::vector<vtkPolyData*> parts(surfaces.begin(), surfaces.end());
    ranges.framing.push_back(liquid_framing(parts, frames.view()));
    ranges.times.push_back(time_of(*parts.front()));
  }
  ranges.framing = followed(ranges.framing, camera_reach(real_time_rate(ranges.times)));
  ranges.checker = checker_of(*surfaces.front());
  ranges.colours = colours_of(fields, surfaces.size(), *surfaces.front());
  return ranges;
}

vtkSmartPointer<vtkPolyData> page_surface(const RunFrames& frames, const PageRanges& ranges,
                                          const std::string& method, int frame) {
  auto surface = frames.surface(method, frame);
  if (ranges.emission) ranges.emission->add_to(*surface, frame);
  return surface;
}

QuantisedSurface quantised(vtkPolyData& surface, const PageRanges& ranges) {
  QuantisedSurface result;
  vtkPointData& arrays = *surface.GetPointData();
  const vtkIdType vertices = surface.GetNumberOfPoints();
  vtkDataArray& id = array_in(arrays, "id", 1, vertices);
  for (vtkIdType v = 0; v < vertices; ++v)
    result.id.push_back(static_cast<std::int64_t>(id.GetComponent(v, 0)));
  add_places(result, *surface.GetPoints()->GetData(), ranges.box);
  add_places(result, rest_of(surface), ranges.rest);
  add_normals(result, array_in(arrays, "Normals", 3, vertices));
  for (const Colouring& colour : ranges.colours) {
    const double* range = colour.table->GetTableRange();
    add_colour(result, *arrays.GetArray(colour.array.c_str()), {range[0], range[1]});
  }
  result.triangles = triangles_of(surface);
  return result;
}

}  // namespace kappaflow
