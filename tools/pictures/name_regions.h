// Surfaces divided along the lines between names.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <string>

namespace kappaflow {

/// A surface whose cells have one name each, in a cell array called as the point array of names (such as
/// `source`) is: where a triangle's corners differ, the part that is nearest to each. Names are not mixed,
/// and their lines do not follow the triangles' edges. Keeps the normals alone.
vtkSmartPointer<vtkPolyData> name_regions(vtkPolyData& surface, const std::string& names);

}  // namespace kappaflow
