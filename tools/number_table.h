// Tables of numbers in CSV files.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace kappaflow {

/// The rows of a CSV file of finite numbers under a header line that must be exactly `header`, e.g. "x,y,z".
/// Blank lines and carriage returns are skipped. Throws InvalidInput with file, line and column; IoError.
std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file,
                                                   std::string_view header);

}  // namespace kappaflow
