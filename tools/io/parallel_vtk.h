// Parallel VTK XML files: which pieces a data set lies in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

/// Whether the ending is .pvtp, .pvtu or .pvti.
bool is_parallel_vtk(const std::filesystem::path& file);

/// The files that such a file lists, which are there; the file itself where it is another. Throws IoError
/// where it cannot be read, is not complete, or one of them is not there or not of the kind.
std::vector<std::filesystem::path> pieces_of(const std::filesystem::path& file);

/// The file that such a file calls by this source, with the same checks.
std::filesystem::path piece_of(const std::filesystem::path& file, const std::string& source);

}  // namespace kappaflow
