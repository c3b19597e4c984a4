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

double number_in(std::string_view cell, bool decimal_commas, const SourcePosition& where) {
  std::string digits(without_quotes(cell));
  if (decimal_commas && std::ranges::count(digits, ',') == 1 && digits.find('.') == std::string::npos)
    std::ranges::replace(digits, ',', '.');
  const std::optional<double> number = parse_number<double>(without_plus(digits));
  if (!number || !std::isfinite(*number))
    throw InvalidInput(
        where, fmt::format("found \"{}\"; expected a finite number{}", one_line(digits, 30),
                           digits.find(',') == std::string_view::npos ? "" : " with a decimal point"));
  return *number;
}

bool is_number(std::string_view cell) {
  std::string digits(without_quotes(cell));
  std::ranges::replace(digits, ',', '.');
  return parse_number<double>(without_plus(digits)).has_value();
}

/// Text that may be UTF-16 behind a byte order mark, as UTF-8 without one; what is no ASCII there becomes ?.
std::string plain_text(std::string text) {
  if (text.starts_with("\xEF\xBB\xBF")) return text.substr(3);
  const bool little = text.starts_with("\xFF\xFE");
  if (!little && !text.starts_with("\xFE\xFF")) return text;
  std::string plain;
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    const char low = text[i + (little ? 0 : 1)], high = text[i + (little ? 1 : 0)];
    plain += high == 0 && low >= 0 ? low : '?';
  }
  return plain;
}

char separator_in(std::string_view line) {
  if (line.find(';') != std::string_view::npos) return ';';
  if (line.find('\t') != std::string_view::npos && line.find(",\t") == std::string_view::npos) return '\t';
  return line.find(',') == std::string_view::npos && line.find(' ') != std::string_view::npos ? ' ' : ',';
}

std::vector<std::string_view> cells_in(std::string_view line, char separator) {
  if (separator != ' ') return csv_cells(line, separator);
  std::vector<std::string_view> cells;
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    cells.push_back(line.substr(0, line.find_first_of(" \t")));
    line.remove_prefix(cells.back().size());
  }
  return cells;
}

/// Without a unit in brackets: "Pos.x [m]" is "Pos.x".
std::string_view without_unit(std::string_view name) {
  return trimmed(name.substr(0, name.find_first_of("[(")));
}

}  // namespace

NumberTable::NumberTable(const std::filesystem::path& file, std::string allowed)
    : file_(file), allowed_(std::move(allowed)), text_(plain_text(read_file(file))) {
  read_header();
  for (const std::string& name : names_) usual_names_.push_back(usual_name(name));
}

/// The names are in the first line that is no comment, or, where that has numbers only, in the comment above
/// it, where NumPy's savetxt writes them.
void NumberTable::read_header() {
  std::string_view comment, line;
  std::size_t at = 0, begin = 0;
  int number = 0;
  while (line.empty() && at < text_.size()) {
    begin = at;
    line = trimmed(line_at(text_, at));
    ++number;
    if (!line.starts_with('#')) continue;
    comment = trimmed(line.substr(1));
    line = {};
  }
  separator_ = separator_in(line.empty() ? comment : line);
  const std::vector<std::string_view> cells = cells_in(line, separator_);
  const bool has_rows_only = line.empty() || std::ranges::all_of(cells, is_number);
  header_ = has_rows_only ? comment : line;
  body_ = has_rows_only ? begin : at;
  lines_above_ = has_rows_only && !line.empty() ? number - 1 : number;
  std::vector<std::string_view> names = cells_in(header_, separator_);
  constexpr std::array<std::string_view, 6> kUsual{"x", "y", "z", "vx", "vy", "vz"};
  has_names_ = line.empty() || names.size() == cells.size();
  if (!has_names_) {
    names.assign(cells.size(), {});
    if (cells.size() == 3 || cells.size() == 6) names.assign(kUsual.begin(), kUsual.begin() + cells.size());
  }
  for (const std::string_view name : names) names_.push_back(lower_case(without_unit(without_quotes(name))));
}

std::vector<std::size_t> NumberTable::find(std::span<const std::string_view> names) const {
  std::vector<std::size_t> columns;
  for (const std::string_view name : names) {
    const auto& found = std::ranges::count(names_, name) > 0 ? names_ : usual_names_;
    const auto at = std::ranges::find(found, name);
    if (at == found.end()) return {};
    if (std::ranges::count(found, name) > 1)
      throw InvalidInput({file_.string(), header_line()},
                         fmt::format("several columns are \"{}\"; expected one", name));
    columns.push_back(at - found.begin());
  }
  return columns;
}

std::vector<std::vector<double>> NumberTable::rows(std::span<const std::size_t> columns) const {
  std::vector<std::vector<double>> rows;
  SourcePosition where{file_.string(), lines_above_, 0};
  for (std::size_t at = body_; at < text_.size();) {
    const std::string_view line = line_at(text_, at);
    ++where.line;
    if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
    const std::vector<std::string_view> cells = cells_in(line, separator_);
    where.column = 0;
    if (cells.size() != names_.size())
      throw InvalidInput(where, fmt::format("found {} values; expected {}", cells.size(), names_.size()));
    std::vector<double>& row = rows.emplace_back();
    for (const std::size_t column : columns) {
      where.column = static_cast<int>(cells[column].data() - line.data()) + 1;
      row.push_back(number_in(cells[column], separator_ != ',', where));
    }
  }
  return rows;
}

int NumberTable::header_line() const {
  return std::max(lines_above_, 1);
}

void NumberTable::refuse_header() const {
  const SourcePosition where{file_.string(), header_line()};
  if (!has_names_)
    throw InvalidInput(where,
                       fmt::format("found {} columns without names; expected a line of names above: {}",
                                   names_.size(), allowed_));
  throw InvalidInput(where,
                     fmt::format("found the header \"{}\"; expected {}", one_line(header_, 60), allowed_));
}

std::vector<std::vector<double>> read_number_table(const std::filesystem::path& file,
                                                   std::string_view header) {
  const NumberTable table(file, fmt::format("{}, in any order", header));
  const std::vector<std::size_t> columns = table.find(csv_cells(header, ','));
  if (columns.empty()) table.refuse_header();
  return table.rows(columns);
}

}  // namespace kappaflow
