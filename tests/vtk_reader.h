// VTK's own reader, to check files that kappaflow writes by what others read.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>

namespace kappaflow {

/// Throws IoError.
vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path);

}  // namespace kappaflow
