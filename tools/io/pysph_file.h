// PySPH's own files.
#pragma once

#include <filesystem>

#include "tools/io/point_data.h"

namespace kappaflow {

/// The liquid of a file that PySPH wrote as HDF5, with the arrays of its particles and its time as the field
/// "time": the one array of particles that there is, or those whose names tell of a fluid or liquid, one
/// after the other with what all of them have. Throws IoError that says what is wrong, InvalidInput where no
/// array is known to be liquid.
PointData read_pysph(const std::filesystem::path& file);

}  // namespace kappaflow
