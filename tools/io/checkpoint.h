// The file that a run goes on from after it was interrupted.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace kappaflow {

/// Of the file and of the state in it; to be raised whenever a serialize() changes.
inline constexpr std::uint32_t kCheckpointFormat = 15;

/// Replaces the file as a whole, and returns when it is on the disk. The file holds, in little-endian order:
/// the 8 bytes "kf-state"; the format (4 bytes); the CRC-32 of the state (4 bytes); its length (8 bytes); the
/// state. Throws IoError; the file is then as it was.
void write_checkpoint(const std::filesystem::path& file, std::string_view state);

/// The state in such a file. Throws InvalidInput where the file has another format, IoError where there is
/// none, or it is not what was written.
std::string read_checkpoint(const std::filesystem::path& file);

}  // namespace kappaflow
