// Whole files.
#pragma once

#include <filesystem>
#include <string>

namespace kappaflow {

/// What the file holds. Throws IoError with the reason where it cannot be read to its end: a folder, a disk
/// that fails, ...
std::string read_file(const std::filesystem::path& path);

}  // namespace kappaflow
