// Points in the files of VTK.
#pragma once

#include <filesystem>

#include "tools/io/point_data.h"

namespace kappaflow {

/// Reads .vtk (legacy), .vtp or .vtu (XML), by the ending of the name in upper or lower case. Throws IoError
/// where the file cannot be read, is damaged, not complete or of another kind.
PointData read_vtk_points(const std::filesystem::path& file);

}  // namespace kappaflow
