// Reads the surface files that kappaflow wrote.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>

namespace kappaflow {

/// The triangles of a surface or of walls, or particles, which have none, with the arrays of points and
/// triangles and the field arrays. Throws IoError, whatever is wrong with the file.
vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& path);

}  // namespace kappaflow
