#include "tools/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "tools/files.h"

namespace kappaflow {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::vector<double> parse_row(std::string_view line, std::size_t columns, SourcePosition where) {
  const std::vector<std::string_view> cells = split(line, ',');
  if (cells.size() != columns)
    throw InvalidInput(where, fmt::format("found {} values; expected {}", cells.size(), columns));
  std::vector<double> row(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const std::string_view cell = trimmed(cells[c]);
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row[c]);
    where.column = static_cast<int>(cells[c].data() - line.data()) + 1;
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(row[c]))
      throw InvalidInput(where, fmt::format("found \"{}\"; expected a finite number", one_line(cell, 30)));
  }
  return row;
}

}  // namespace

std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file,
                                                   std::string_view header) {
  const std::string text = read_file(file);
  const std::vector<std::string_view> lines = split(text, '\n');
  SourcePosition where{file.string(), 1, 0};
  if (trimmed(lines[0]) != header)
    throw InvalidInput(where, fmt::format("found the header \"{}\"; expected \"{}\"",
                                          one_line(trimmed(lines[0]), 60), header));
  const std::size_t columns = split(header, ',').size();
  std::vector<std::vector<double>> rows;
  for (std::size_t l = 1; l < lines.size(); ++l) {
    where.line = static_cast<int>(l) + 1;
    if (const std::string_view line = trimmed(lines[l]); !line.empty())
      rows.push_back(parse_row(line, columns, where));
  }
  return rows;
}

}  // namespace kappaflow
