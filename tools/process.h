// Other programs that do a part of the work.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

inline constexpr int kProgramMissing = 127;  ///< as shells have it

/// Runs a program of PATH with these words (the first is its name) in `folder`, without its standard output.
/// Returns its exit status, 128 + the signal that ended it, or kProgramMissing where it is not there.
int run_command(std::vector<std::string> words, const std::filesystem::path& folder);

}  // namespace kappaflow
