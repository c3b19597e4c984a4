#include "tools/pictures/surface_arrays.h"

#include <fmt/format.h>
#include <vtkNew.h>

#include "core/errors.h"

namespace kappaflow {

vtkDataArray& array_in(vtkFieldData& arrays, const char* name, int components, vtkIdType tuples) {
  vtkDataArray* const array = arrays.GetArray(name);
  if (array == nullptr || array->GetNumberOfComponents() != components || array->GetNumberOfTuples() < tuples)
    throw InvalidInput(fmt::format("the surface has no array \"{}\", which pictures of it need", name));
  return *array;
}

Checker checker_of(vtkPolyData& surface) {
  vtkFieldData& arrays = *surface.GetFieldData();
  return {Vec3(array_in(arrays, "checker_origin", 3, 1).GetTuple3(0)),
          array_in(arrays, "checker_edge", 1, 1).GetTuple1(0)};
}

std::vector<Triangle> triangles_of(vtkPolyData& surface) {
  std::vector<Triangle> triangles;
  triangles.reserve(static_cast<std::size_t>(surface.GetNumberOfCells()));
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < surface.GetNumberOfCells(); ++t) {
    surface.GetCellPoints(t, corners);
    triangles.push_back({static_cast<int>(corners->GetId(0)), static_cast<int>(corners->GetId(1)),
                         static_cast<int>(corners->GetId(2))});
  }
  return triangles;
}

}  // namespace kappaflow
