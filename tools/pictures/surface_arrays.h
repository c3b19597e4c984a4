// What pictures need of a surface file.
#pragma once

#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPolyData.h>

#include "surface/measure/texture.h"

namespace kappaflow {

/// An array with so many components and at least so many tuples. Throws InvalidInput where there is none.
vtkDataArray& array_in(vtkFieldData& arrays, const char* name, int components, vtkIdType tuples);

/// Where the surface's checker has its cubes. Throws InvalidInput where the file does not say.
Checker checker_of(vtkPolyData& surface);

}  // namespace kappaflow
