#include "tools/io/exported_arrays.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "tools/io/surface_file.h"

namespace kappaflow {
namespace {

NumberType exported_type(vtkDataArray& array) {
  const std::string_view name = array.GetName();
  if (name == "id") return NumberType::int64;
  if (name.starts_with("rest_") && array.GetNumberOfComponents() == 3) return NumberType::float64;
  if (vtkIntArray::SafeDownCast(&array) != nullptr) return NumberType::int32;
  if (vtkUnsignedCharArray::SafeDownCast(&array) != nullptr) return NumberType::uint8;
  return NumberType::float32;
}

PointArray exported_array(vtkDataArray& array) {
  const std::string_view name = array.GetName();
  PointArray exported{std::string(name == "rest_position" ? "rest" : name),
                      static_cast<std::size_t>(array.GetNumberOfComponents()),
                      {},
                      exported_type(array)};
  exported.values.reserve(static_cast<std::size_t>(array.GetNumberOfValues()));
  for (vtkIdType i = 0; i < array.GetNumberOfTuples(); ++i)
    for (int c = 0; c < array.GetNumberOfComponents(); ++c)
      exported.values.push_back(array.GetComponent(i, c));
  return exported;
}

std::vector<Vec3> vectors_in(const PointArray& array) {
  std::vector<Vec3> vectors;
  for (std::size_t i = 0; i + 2 < array.values.size(); i += 3) vectors.emplace_back(&array.values[i]);
  return vectors;
}

std::vector<Rgb> colours_in(const PointArray& array) {
  std::vector<Rgb> colours(array.values.size() / 3);
  for (std::size_t i = 0; i < array.values.size(); ++i)
    colours[i / 3][i % 3] = static_cast<std::uint8_t>(array.values[i]);
  return colours;
}

}  // namespace

PointData exported_points(vtkPolyData& data) {
  PointData points;
  for (vtkIdType i = 0; i < data.GetNumberOfPoints(); ++i) points.position.emplace_back(data.GetPoint(i));
  for (int a = 0; a < data.GetPointData()->GetNumberOfArrays(); ++a)
    points.arrays.push_back(exported_array(*data.GetPointData()->GetArray(a)));
  return points;
}

ExportedSurface exported_surface(vtkPolyData& surface, const TextureMap& map) {
  PointData points = exported_points(surface);
  ExportedSurface exported;
  exported.triangles = triangles_of(surface);
  exported.normal.resize(points.position.size(), Vec3::Zero());
  exported.colour.resize(points.position.size(), Rgb{200, 200, 200});
  exported.rest = points.position;
  for (PointArray& array : points.arrays) {
    if (array.name == "rest") exported.rest = vectors_in(array);
    if (array.name == "Normals")
      exported.normal = vectors_in(array);
    else if (array.name == "checker")
      exported.colour = colours_in(array);
    else if (array.name != "TCoords")
      exported.arrays.push_back(std::move(array));
  }
  exported.texture = seamless_texture(exported.rest, exported.triangles, map.box, map.projection);
  exported.position = std::move(points.position);
  return exported;
}

std::vector<TriangleSurface> exported_walls(vtkPolyData& boundary) {
  std::vector<TriangleSurface> walls;
  std::vector<int> number(static_cast<std::size_t>(boundary.GetNumberOfPoints()), -1);  // in its wall
  const std::vector<Triangle> triangles = triangles_of(boundary);
  vtkDataArray* const wall = boundary.GetCellData()->GetArray("wall");
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double w = wall == nullptr ? 0 : wall->GetComponent(static_cast<vtkIdType>(t), 0);
    if (w >= static_cast<double>(walls.size())) walls.resize(static_cast<std::size_t>(w) + 1);
    TriangleSurface& surface = walls[static_cast<std::size_t>(w)];
    Triangle& corners = surface.triangles.emplace_back();
    for (int c = 0; c < 3; ++c) {
      int& vertex = number[triangles[t][c]];
      if (vertex < 0) {
        vertex = static_cast<int>(surface.vertices.size());
        surface.vertices.emplace_back(boundary.GetPoint(triangles[t][c]));
      }
      corners[c] = vertex;
    }
  }
  return walls;
}

TexturedMesh ExportedSurface::mesh(bool z_up) const {
  return {position, normal, texture.value, colour, triangles, texture.corners, arrays, z_up};
}

bool is_rest_position(const PointArray& array) {
  return array.name.starts_with("rest") && array.components == 3;
}

std::int32_t whole_of_32_bits(double value) {
  constexpr double kModulus = 2147483648.0;  // 2^31
  return static_cast<std::int32_t>(std::fmod(value, kModulus));
}

double linear_light(std::uint8_t channel) {
  const double c = channel / 255.0;
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

Vec3 far_origin(std::span<const Vec3> position) {
  constexpr double kFar =
      16;  // in sizes of the mesh: up to there its positions are right to a millionth of it
  const Bounds box = bounding_box(position);
  const Vec3 middle = (box.lower + box.upper) / 2;
  if (!(middle.lpNorm<Eigen::Infinity>() > kFar * (box.upper - box.lower).maxCoeff())) return Vec3::Zero();
  return middle.cast<float>().cast<double>();
}

}  // namespace kappaflow
