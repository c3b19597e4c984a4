// Where this program is.
#pragma once

#include <filesystem>

namespace kappaflow {

/// The file of the program that runs: what belongs to it lies beside it, where it was built and where it was
/// installed. Throws IoError where the system does not say.
std::filesystem::path program_file();

}  // namespace kappaflow
