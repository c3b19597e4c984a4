#include "tools/io/number_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/csv.h"

namespace kappaflow {
namespace {

std::string_view trimmed(std::string_view text, std::string_view blanks = " \t") {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string_view without_quotes(std::string_view cell) {
  cell = trimmed(cell);
  const bool quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return quoted ? trimmed(cell.substr(1, cell.size() - 2)) : cell;
}

/// x, y, z and vx, vy, vz for a component of positions or velocities: Points:0, velocity_1, pos.z.
std::string usual_name(const std::string& name) {
  constexpr std::array<std::string_view, 4> kPositions{"points", "position", "positions", "pos"},
      kVelocities{"velocity", "velocities", "vel", "v"};
  if (name.size() < 3) return name;
  const std::size_t mark = name.size() - 2, number = std::string_view("012").find(name.back()),
                    letter = std::string_view("xyz").find(name.back());
  const std::size_t component = std::min(number, letter);
  if (std::string_view(":_.").find(name[mark]) == std::string_view::npos || component > 2) return name;
  const std::string_view vector = std::string_view(name).substr(0, mark);
  const char axis = "xyz"[component];
  if (std::ranges::count(kPositions, vector) > 0) return {axis};
  if (std::ranges::count(kVelocities, vector) > 0) return {'v', axis};
  return name;
}

double number_in(std::string_view cell, const SourcePosition& where) {
  const std::string_view digits = without_quotes(cell);
  const std::optional<double> number = parse_number<double>(digits);
  if (!number || !std::isfinite(*number))
    throw InvalidInput(
        where, fmt::format("found \"{}\"; expected a finite number{}", one_line(digits, 30),
                           digits.find(',') == std::string_view::npos ? "" : " with a decimal point"));
  return *number;
}

}  // namespace

NumberTable::NumberTable(const std::filesystem::path& file, std::string allowed)
    : file_(file), allowed_(std::move(allowed)), text_(read_file(file)) {
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF"))
    throw InvalidInput({file.string()},
                       "is text in UTF-16, as Windows PowerShell's > writes it; expected UTF-8, as "
                       "Out-File -Encoding utf8 does");
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);
  std::string_view header = trimmed(line_at(text_, body_));
  if (header.starts_with('#')) header.remove_prefix(1);  // as NumPy's savetxt writes it
  if (header.find(';') != std::string_view::npos) separator_ = ';';
  for (const std::string_view cell : csv_cells(header, separator_)) {
    names_.push_back(lower_case(without_quotes(cell)));
    usual_names_.push_back(usual_name(names_.back()));
  }
}

std::vector<std::size_t> NumberTable::find(std::span<const std::string_view> names) const {
  std::vector<std::size_t> columns;
  for (const std::string_view name : names) {
    const auto& found = std::ranges::count(names_, name) > 0 ? names_ : usual_names_;
    const auto at = std::ranges::find(found, name);
    if (at == found.end()) return {};
    if (std::ranges::count(found, name) > 1)
      throw InvalidInput({file_.string(), 1}, fmt::format("several columns are \"{}\"; expected one", name));
    columns.push_back(at - found.begin());
  }
  return columns;
}

std::vector<std::vector<double>> NumberTable::rows(std::span<const std::size_t> columns) const {
  std::vector<std::vector<double>> rows;
  SourcePosition where{file_.string(), 1, 0};
  for (std::size_t at = body_; at < text_.size();) {
    const std::string_view line = line_at(text_, at);
    ++where.line;
    if (trimmed(line).empty()) continue;
    const std::vector<std::string_view> cells = csv_cells(line, separator_);
    where.column = 0;
    if (cells.size() != names_.size())
      throw InvalidInput(where, fmt::format("found {} values; expected {}", cells.size(), names_.size()));
    std::vector<double>& row = rows.emplace_back();
    for (const std::size_t column : columns) {
      where.column = static_cast<int>(cells[column].data() - line.data()) + 1;
      row.push_back(number_in(cells[column], where));
    }
  }
  return rows;
}

void NumberTable::refuse_header() const {
  std::size_t begin = 0;
  throw InvalidInput({file_.string(), 1},
                     fmt::format("found the header \"{}\"; expected {}",
                                 one_line(trimmed(line_at(text_, begin)), 60), allowed_));
}

std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file,
                                                   std::string_view header) {
  const NumberTable table(file, fmt::format("{}, in any order", header));
  const std::vector<std::size_t> columns = table.find(csv_cells(header, ','));
  if (columns.empty()) table.refuse_header();
  return table.rows(columns);
}

}  // namespace kappaflow
