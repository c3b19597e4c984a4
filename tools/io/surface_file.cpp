#include "tools/io/surface_file.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkUnsignedCharArray.h>

#include <limits>
#include <type_traits>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_arrays.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {
namespace {

template <class Array>
vtkSmartPointer<Array> array_as(const PointArray& array) {
  using Number = typename Array::ValueType;
  using Limits = std::numeric_limits<Number>;
  constexpr std::size_t kMostComponents = 9;  // of a tensor
  if (array.components < 1 || array.components > kMostComponents)
    throw InvalidInput(fmt::format("array \"{}\" has {} components; expected 1 to {}",
                                   one_line(array.name, 30), array.components, kMostComponents));
  if constexpr (std::is_integral_v<Number>)
    for (const double value : array.values)
      if (!(value >= Limits::min() && value <= Limits::max()))
        throw InvalidInput(fmt::format("array \"{}\" has the number {}", one_line(array.name, 30), value));
  return make_array<Array>(array.name.c_str(), static_cast<int>(array.components),
                           array.values.size() / array.components,
                           [&](std::size_t i) { return array.values.data() + array.components * i; });
}

/// Int32 and UInt8 stay what they are: whole numbers may be names, and bytes colours.
vtkSmartPointer<vtkDataArray> array_to_draw(const PointArray& array) {
  if (array.type == NumberType::int32) return array_as<vtkIntArray>(array);
  if (array.type == NumberType::uint8) return array_as<vtkUnsignedCharArray>(array);
  return array_as<vtkDoubleArray>(array);
}

void check_finite_points(const PointData& data) {
  for (std::size_t v = 0; v < data.position.size(); ++v)
    if (!data.position[v].allFinite()) throw InvalidInput(fmt::format("vertex {} is nowhere", v));
}

}  // namespace

vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  try {
    const VtkSurface surface = parse_vtk_surface(bytes);
    check_finite_points(surface.points);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(make_points(surface.points.position));
    data->SetPolys(make_triangles(surface.triangles));
    for (const PointArray& array : surface.points.arrays)
      data->GetPointData()->AddArray(array_to_draw(array));
    for (const PointArray& array : surface.cell_arrays) data->GetCellData()->AddArray(array_to_draw(array));
    data->GetPointData()->SetActiveNormals("Normals");
    for (const PointArray& array : surface.points.fields)
      data->GetFieldData()->AddArray(array_to_draw(array));
    return data;
  } catch (const InvalidInput& error) {
    throw IoError(path.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

std::vector<Triangle> triangles_of(vtkPolyData& surface) {
  std::vector<Triangle> triangles;
  vtkCellArray& cells = *surface.GetPolys();
  triangles.reserve(static_cast<std::size_t>(cells.GetNumberOfCells()));
  vtkIdType corners = 0;
  const vtkIdType* corner = nullptr;
  for (vtkIdType t = 0; t < cells.GetNumberOfCells(); ++t) {
    cells.GetCellAtId(t, corners, corner);
    triangles.push_back(
        {static_cast<int>(corner[0]), static_cast<int>(corner[1]), static_cast<int>(corner[2])});
  }
  return triangles;
}

}  // namespace kappaflow
