// Reads the surface files that kappaflow wrote.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>

namespace kappaflow {

/// The triangles of a surface or of walls, with the arrays of its points and its field arrays. Throws
/// IoError, whatever is wrong with the file.
vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& path);

}  // namespace kappaflow
