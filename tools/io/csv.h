// Lines and cells of CSV files.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace kappaflow {

/// The text up to the end of the line that begins at `at`, which moves on to the next line; lines end with
/// \n, \r\n or \r.
std::string_view line_at(std::string_view text, std::size_t& at);

/// The cells of a line, which may hold separators between quotes; with their quotes and blanks.
std::vector<std::string_view> csv_cells(std::string_view line, char separator = ',');

}  // namespace kappaflow
