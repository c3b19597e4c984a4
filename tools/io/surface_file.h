// Reads the surface files that kappaflow wrote.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// The triangles of a surface or of walls, or particles, which have none, with the arrays of points and
/// triangles and the field arrays. Throws IoError, whatever is wrong with the file.
vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& path);

/// Precondition: all polygons are triangles, as read_surface() and surface_data() make them.
std::vector<Triangle> triangles_of(vtkPolyData& surface);

}  // namespace kappaflow
