// Whole files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>

namespace kappaflow {

/// What the file holds, of a longer one its first `most_bytes`. Throws IoError with the reason where it
/// cannot be opened or read: a folder, a disk that fails, ...
std::string read_file(const std::filesystem::path& path,
                      std::size_t most_bytes = std::numeric_limits<std::size_t>::max());

}  // namespace kappaflow
