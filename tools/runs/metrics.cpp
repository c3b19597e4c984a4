#include "tools/runs/metrics.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/errors.h"
#include "core/read_file.h"
#include "tools/io/csv.h"

namespace kappaflow {
namespace {

/// The columns of a header; null where one is not known. Throws InvalidInput for another table's header.
std::vector<const MetricColumn*> columns_of(std::string_view header) {
  std::vector<const MetricColumn*> columns;
  for (const std::string_view name : csv_cells(header)) columns.push_back(find_metric(name));
  const auto count = [&](const MetricColumn* column) { return std::ranges::count(columns, column); };
  const auto is_repeated = [&](const MetricColumn* column) { return column != nullptr && count(column) > 1; };
  if (count(find_metric("time")) != 1 || count(find_metric("method")) != 1 ||
      std::ranges::any_of(columns, is_repeated))
    throw InvalidInput("is not a table of metrics");
  return columns;
}

MetricsRow row_of(std::string_view line, std::span<const MetricColumn* const> columns) {
  const std::vector<std::string_view> cells = csv_cells(line);
  if (cells.size() != columns.size())
    throw InvalidInput(cells.size() < columns.size() ? "has too few cells" : "has too many cells");
  MetricsRow row;
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (columns[c] != nullptr) columns[c]->read(cells[c], row);
  return row;
}

MetricsTable table_of(std::string_view text, const std::filesystem::path& file) {
  MetricsTable table;
  std::size_t at = 0;
  try {
    table.columns = columns_of(line_at(text, at));
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), error.what());
  }
  while (at < text.size()) try {
      table.rows.push_back(row_of(line_at(text, at), table.columns));
    } catch (const InvalidInput& error) {
      throw IoError(file.string(), fmt::format("row {} {}", table.rows.size() + 1, error.what()));
    }
  std::erase(table.columns, nullptr);
  return table;
}

}  // namespace

std::string taken_text(std::span<const std::size_t> taken) {
  return fmt::format("{}", fmt::join(taken, " "));
}

const MetricColumn* find_metric(std::string_view name) {
  const auto found = std::ranges::find(metric_columns(), name, &MetricColumn::name);
  return found == metric_columns().end() ? nullptr : &*found;
}

std::string metrics_header() {
  std::string header;
  for (const MetricColumn& column : metric_columns())
    header += fmt::format("{}{}", header.empty() ? "" : ",", column.name);
  return header + '\n';
}

std::string metrics_row(const MetricsRow& row) {
  std::string line;
  for (const MetricColumn& column : metric_columns())
    line += fmt::format("{}{}", line.empty() ? "" : ",", column.cell(row));
  return line + '\n';
}

MetricsTable read_metrics_table(const std::filesystem::path& file) {
  return table_of(read_file(file), file);
}

std::vector<MetricsRow> read_metrics(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  if (!text.starts_with(metrics_header()))
    throw IoError(file.string(), "is not a table of metrics of this version of kappaflow");
  return table_of(text, file).rows;
}

std::string pieces_header() {
  return "frame,time,method,piece,vertices,rotation_captured\n";
}

std::string pieces_rows(const MetricsRow& row) {
  std::string rows;
  for (std::size_t p = 0; p < row.surface.pieces.size(); ++p) {
    const auto& [vertices, captured] = row.surface.pieces[p];
    rows += fmt::format("{},{:.12g},{},{},{},{}\n", row.frame.frame, row.frame.time, row.method, p, vertices,
                        captured ? fmt::format("{:.12g}", *captured) : std::string());
  }
  return rows;
}

}  // namespace kappaflow
