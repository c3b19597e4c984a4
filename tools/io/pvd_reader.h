// ParaView data files (.pvd), read: what belongs to which time.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/io/pvd.h"

namespace kappaflow {

/// The data files that a .pvd lists, in its order. Throws IoError where it cannot be read or is no .pvd,
/// InvalidInput where a time is no number.
std::vector<PvdEntry> read_pvd(const std::filesystem::path& file);

}  // namespace kappaflow
