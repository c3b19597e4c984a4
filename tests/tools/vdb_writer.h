// Level sets as OpenVDB's programs write them. C++17 where there is OpenVDB, see tools/io/vdb_file.h.
#pragma once

#include <filesystem>

#include "tools/io/image_file.h"

namespace kappaflow {

/// Writes the distances as a level set "surface" of a narrow band, three spacings to either side, with its
/// time. The frame's spacing must be one. False where this was built without OpenVDB: nothing is written.
bool write_vdb(const std::filesystem::path& file, const ImageFrame& frame);

}  // namespace kappaflow
