// The arrays of a surface file that pictures need.
#pragma once

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>

#include "core/errors.h"

namespace kappaflow {

/// An array with so many components and at least so many tuples. Throws InvalidInput where there is none.
inline vtkDataArray& array_in(vtkFieldData& arrays, const char* name, int components, vtkIdType tuples) {
  vtkDataArray* const array = arrays.GetArray(name);
  if (array == nullptr || array->GetNumberOfComponents() != components || array->GetNumberOfTuples() < tuples)
    throw InvalidInput(fmt::format("the surface has no array \"{}\", which pictures of it need", name));
  return *array;
}

}  // namespace kappaflow
