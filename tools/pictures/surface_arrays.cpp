#include "tools/pictures/surface_arrays.h"

#include <fmt/format.h>

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

}  // namespace kappaflow
