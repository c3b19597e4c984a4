#include "tools/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>

#include "core/errors.h"
#include "core/named.h"
#include "tools/files.h"
#include "tools/plot.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What makes a value of a metric a good one.
enum class Best { none, least, most, one };

/// Columns of metrics.csv, and volume_error, which is made of two of them. Those that are not here are the
/// same for all methods of a run.
constexpr Named<Best> kMetrics[] = {
    {"slip", Best::least},
    {"rotation_captured", Best::one},
    {"tracer_distance", Best::least},
    {"volume_error", Best::least},
    {"residual_max", Best::least},
    {"quality_min", Best::most},
    {"quality_mean", Best::most},
    {"angles_outside", Best::least},
    {"folded_fraction", Best::least},
    {"self_intersections", Best::least},
    {"unprojected", Best::least},
    {"texture_jump", Best::least},
    {"texture_cracks", Best::least},
    {"kept_fraction", Best::most},
    {"kept_since_frame", Best::most},
    {"surface_without_mesh", Best::least},
    {"mesh_without_surface", Best::least},
    {"vertices_replaced", Best::least},
    {"regions_replaced", Best::none},
    {"regions_refused", Best::least},
    {"vertices", Best::none},
    {"triangles", Best::none},
    {"area", Best::none},
    {"volume", Best::none},
    {"components", Best::none},
    {"genus", Best::none},
};

/// One method of one run: its columns over the frames; nan where a cell is empty.
struct Series {
  std::string name;
  std::map<std::string, std::vector<double>, std::less<>> column;

  std::vector<double> values(std::string_view metric) const {
    if (const auto found = column.find(metric); found != column.end()) return found->second;
    return std::vector<double>(column.at("time").size(), kNone);
  }
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  if (line.ends_with(',')) cells.emplace_back();
  return cells;
}

void add_volume_error(Series& series) {
  const std::vector<double> tracked = series.values("volume"), fresh = series.values("isosurface_volume");
  std::vector<double>& error = series.column["volume_error"];
  for (std::size_t f = 0; f < tracked.size(); ++f) error.push_back(std::abs(tracked[f] / fresh[f] - 1));
}

std::vector<Series> read_run(const fs::path& run, const std::string& prefix) {
  const fs::path file = run / "metrics.csv";
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = cells_of(line);
  const auto method_column = std::ranges::find(names, "method") - names.begin();
  std::vector<Series> all;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != names.size() || method_column == std::ssize(names))
      throw IoError(file.string(), "is not a table of metrics");
    const std::string name = prefix + cells[method_column];
    auto series = std::ranges::find(all, name, &Series::name);
    if (series == all.end()) series = all.insert(all.end(), Series{name, {}});
    for (std::size_t c = 0; c < cells.size(); ++c)
      series->column[names[c]].push_back(cells[c].empty() ? kNone : std::strtod(cells[c].c_str(), nullptr));
  }
  if (all.empty()) throw IoError(file.string(), "holds no frames yet");
  std::ranges::for_each(all, add_volume_error);
  return all;
}

/// The median of the values that there are; nan where there are none.
double median_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  if (values.empty()) return kNone;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// How far a value is from the best; nan stays nan.
double badness(double value, Best best) {
  return best == Best::most ? -value : best == Best::one ? std::abs(value - 1) : value;
}

/// The names of the series that do best; empty where they are all alike, or where there is no best.
std::string best_names(const std::vector<Series>& all, const std::vector<double>& medians, Best best) {
  if (best == Best::none) return {};
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const double value : medians)
    if (!std::isnan(value)) {
      least = std::min(least, badness(value, best));
      most = std::max(most, badness(value, best));
    }
  std::vector<std::string> names;
  for (std::size_t s = 0; s < all.size(); ++s)
    if (least < most && badness(medians[s], best) == least) names.push_back(all[s].name);
  return fmt::format("{}", fmt::join(names, " "));
}

std::string number(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.4g}", value);
}

/// The table with every cell a text: a header, and a row a metric.
std::vector<std::vector<std::string>> table_of(const std::vector<Series>& all) {
  std::vector<std::vector<std::string>> rows{{"median"}};
  for (const Series& series : all) rows[0].push_back(series.name);
  rows[0].emplace_back("best");
  for (const auto& [metric, best] : kMetrics) {
    std::vector<double> medians;
    medians.reserve(all.size());
    for (const Series& series : all) medians.push_back(median_of(series.values(metric)));
    std::vector<std::string>& row = rows.emplace_back();
    row.emplace_back(metric);
    for (const double value : medians) row.push_back(number(value));
    row.push_back(best_names(all, medians, best));
  }
  return rows;
}

std::string terminal_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> width(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  std::string text;
  for (const auto& row : rows) {
    text += fmt::format("{:<{}}", row[0], width[0]);
    for (std::size_t c = 1; c + 1 < row.size(); ++c) text += fmt::format("  {:>{}}", row[c], width[c]);
    text += row.back().empty() ? "\n" : fmt::format("  {}\n", row.back());
  }
  return text;
}

std::string markdown_text(const std::vector<std::vector<std::string>>& rows) {
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    text += fmt::format("| {} |\n", fmt::join(rows[r], " | "));
    if (r > 0) continue;
    for (std::size_t c = 0; c < rows[r].size(); ++c) text += "|---";
    text += "|\n";
  }
  return text;
}

/// Whether there is anything to see: gnuplot complains about curves that are all one constant.
bool changes(const Plot& plot) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Curve& curve : plot.curves)
    for (const Vec2& point : curve.points)
      if (!std::isnan(point.y())) least = std::min(least, point.y()), most = std::max(most, point.y());
  return least < most;
}

void write_plots(const fs::path& folder, const std::vector<Series>& all) {
  for (const auto& [metric, best] : kMetrics) {
    Plot plot{std::string(metric), "t [s]", std::string(metric), {}};
    for (const Series& series : all) {
      const std::vector<double> time = series.values("time"), values = series.values(metric);
      Curve curve{series.name, {}};
      for (std::size_t f = 0; f < time.size(); ++f) curve.points.emplace_back(time[f], values[f]);
      if (!std::isnan(median_of(values))) plot.curves.push_back(std::move(curve));
    }
    if (changes(plot)) draw_plots(folder, std::string(metric), {&plot, 1});
  }
}

}  // namespace

std::string compare(const CompareOptions& options) {
  std::vector<Series> all;
  for (const fs::path& run : options.runs) {
    const std::string prefix = options.runs.size() > 1 ? run.string() + ":" : std::string();
    std::ranges::move(read_run(run, prefix), std::back_inserter(all));
  }
  const auto rows = table_of(all);
  if (!options.folder.empty()) {
    require_gnuplot();
    make_folder(options.folder);
    std::string csv;
    for (const auto& row : rows) csv += fmt::format("{}\n", fmt::join(row, ","));
    write_file(options.folder / "compare.csv", csv);
    write_file(options.folder / "compare.md", markdown_text(rows));
    write_plots(options.folder, all);
  }
  return terminal_text(rows);
}

}  // namespace kappaflow
