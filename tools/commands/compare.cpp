#include "tools/commands/compare.h"

#include <fmt/format.h>
#include <vtk_jsoncpp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/errors.h"
#include "core/quantile.h"
#include "tools/io/files.h"
#include "tools/pictures/method_curve.h"
#include "tools/runs/metrics.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/run_record.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

constexpr std::string_view kTime = "time_a_frame";

/// A column of metrics.csv; or volume_error, which is made of two of them; or time_a_frame, the wall time
/// that the surface takes [s], which is of timings.csv. noise: medians that differ by less are alike, as a
/// share of the greater of the two, of rotation_captured as it is. So much any two medians of a method differ
/// when the liquid of staircase-small.toml (1 s) begins none, one, two or three tenths of a spacing further.
struct Metric {
  std::string_view name;
  double noise = 0;

  Better better() const {
    const MetricColumn* column = find_metric(name);
    return column == nullptr ? Better::lower : column->better;
  }
};

/// In the order of the table: how the surface moves, then what becomes of the mesh. Columns that are not here
/// are the same for all methods of a run, or say of the mesh what others say better.
constexpr Metric kMetrics[] = {
    {"slip", 0.12},
    {"rotation_captured", 0.05},
    {"tracer_distance", 0.11},
    {"texture_distance", 0.15},
    {"volume_error", 0.38},
    {"residual_max", 0.01},
    {kTime, 0.2},
    {"quality_min", 0.06},
    {"quality_mean", 0.01},
    {"angles_outside"},
    {"folded_fraction"},
    {"self_intersections"},
    {"unprojected"},
    {"texture_jump", 0.05},
    {"texture_cracks", 0.14},
    {"texture_flicker", 0.2},
    {"kept_fraction", 0.06},
    {"kept_since_frame", 0.01},
    {"surface_without_mesh", 0.12},
    {"mesh_without_surface", 0.15},
    {"vertices_replaced"},
    {"regions_replaced"},
    {"regions_refused"},
    {"vertices"},
    {"triangles"},
    {"area"},
    {"volume"},
    {"components"},
    {"genus"},
};

constexpr double kRounding = 1e-9;  // smaller differences are that

/// What the others are measured against is not one of them.
constexpr std::string_view kReferences[] = {"normal", "material"};

constexpr std::size_t kTerminalWidth = 120;

/// One method of one run: its columns over the frames; nan where a cell is empty.
struct Series {
  std::string method;
  std::map<std::string_view, std::vector<double>> column;

  std::vector<double> values(std::string_view metric) const {
    if (const auto found = column.find(metric); found != column.end()) return found->second;
    return std::vector<double>(times().size(), kNone);
  }
  const std::vector<double>& times() const { return column.at("time"); }
  /// run: what it is called, nothing where there is only one.
  std::string name(const std::string& called) const { return called + (called.empty() ? "" : ":") + method; }
  bool competes() const { return std::ranges::find(kReferences, method) == std::end(kReferences); }
};

void add_volume_error(Series& series) {
  const std::vector<double> tracked = series.values("volume"), fresh = series.values("isosurface_volume");
  std::vector<double>& error = series.column["volume_error"];
  for (std::size_t f = 0; f < tracked.size(); ++f) error.push_back(std::abs(tracked[f] / fresh[f] - 1));
}

/// Without the first mesh, which the first method bears for all.
void add_time_a_frame(const std::vector<SurfaceTime>& times, Series& series) {
  const std::vector<double> frames = series.values("frame");
  std::vector<double>& seconds = series.column[kTime];
  seconds.assign(frames.size(), kNone);
  for (const SurfaceTime& time : times) {
    const auto frame = std::ranges::find(frames, static_cast<double>(time.frame));
    if (time.method == series.method && time.frame > 0 && frame != frames.end())
      seconds[frame - frames.begin()] = time.seconds;
  }
}

/// The run's tables of metrics and times, method by method.
std::vector<Series> read_series(const fs::path& run) {
  const fs::path file = run / kMetricsFile;
  const MetricsTable table = read_metrics_table(file);
  std::vector<Series> all;
  for (const MetricsRow& row : table.rows) {
    auto series = std::ranges::find(all, row.method, &Series::method);
    if (series == all.end()) series = all.insert(all.end(), Series{row.method, {}});
    for (const MetricColumn* column : table.columns)
      series->column[column->name].push_back(column->number(row));
  }
  if (all.empty()) throw IoError(file.string(), "holds no frames yet");
  std::ranges::for_each(all, add_volume_error);
  const std::vector<SurfaceTime> times = read_surface_times(run / kTimingsFile);
  for (Series& series : all) add_time_a_frame(times, series);
  return all;
}

struct Run {
  fs::path folder;
  std::string title;    ///< of the scene, or the name of the sequence that was tracked
  std::string subject;  ///< the same for runs of the same scene or sequence
  std::vector<Series> series;

  std::size_t frames() const { return series.front().times().size(); }
  double end() const { return series.front().times().back(); }
};

Run read_run(const fs::path& folder) {
  const Json::Value record = read_record(folder);
  const Json::Value &scene = record["scene"], &sequence = record["sequence"];
  Run run{folder, {}, {}, read_series(folder)};
  if (scene.isObject()) {
    run.title = scene["title"].asString();
    run.subject = scene["hash"].asString();
  } else if (sequence.isObject()) {
    run.title = sequence["name"].asString();
    run.subject = sequence.isMember("hash")
                      ? sequence["hash"].asString()
                      : fmt::format("{} {}", sequence["first"].asString(), sequence["last"].asString());
  }
  return run;
}

/// The median of the values that there are up to a time; nan where there are none.
double median_of(const Series& series, std::string_view metric, double end) {
  std::vector<double> values = series.values(metric);
  for (std::size_t f = 0; f < values.size(); ++f)
    if (series.times()[f] > end + kRounding) values[f] = kNone;
  std::erase_if(values, [](double value) { return std::isnan(value); });
  return values.empty() ? kNone : upper_median(values);
}

/// How far a value is from the best; nan stays nan.
double badness(double value, Better better) {
  return better == Better::higher ? -value : better == Better::nearer_to_one ? std::abs(value - 1) : value;
}

/// Whether a value is better than another by more than noise.
bool is_better(double value, double other, const Metric& metric) {
  const Better better = metric.better();
  const double scale = better == Better::nearer_to_one ? 1 : std::max(std::abs(value), std::abs(other));
  return badness(other, better) - badness(value, better) > std::max(metric.noise * scale, kRounding);
}

/// A metric of every series.
struct Row {
  std::string_view metric;
  std::vector<double> medians;
  std::vector<bool> best;  ///< those that nobody is better than; none where they all are
};

Row row_of(const std::vector<Series>& all, const Metric& metric, double end) {
  Row row{metric.name, {}, std::vector<bool>(all.size(), false)};
  for (const Series& series : all) row.medians.push_back(median_of(series, metric.name, end));
  if (metric.better() == Better::neither) return row;
  const auto competes = [&](std::size_t s) { return all[s].competes() && !std::isnan(row.medians[s]); };
  const auto beaten = [&](std::size_t s) {
    for (std::size_t other = 0; other < all.size(); ++other)
      if (competes(other) && is_better(row.medians[other], row.medians[s], metric)) return true;
    return false;
  };
  bool some_beaten = false;
  for (std::size_t s = 0; s < all.size(); ++s) {
    if (!competes(s)) continue;
    row.best[s] = !beaten(s);
    some_beaten = some_beaten || !row.best[s];
  }
  if (!some_beaten) row.best.assign(all.size(), false);
  return row;
}

std::string number(double value) {
  return std::isnan(value) ? std::string() : fmt::format("{:.4g}", value);
}

/// The table with every cell a text: a header, and a row a metric, with the names of the best at its end.
std::vector<std::vector<std::string>> cells_of(const std::vector<Row>& rows,
                                               const std::vector<std::string>& names) {
  std::vector<std::vector<std::string>> cells{{"median"}};
  cells[0].insert(cells[0].end(), names.begin(), names.end());
  cells[0].emplace_back("best");
  for (const Row& row : rows) {
    std::vector<std::string>& line = cells.emplace_back();
    std::vector<std::string> best;
    line.emplace_back(row.metric);
    for (std::size_t s = 0; s < names.size(); ++s) {
      line.push_back(number(row.medians[s]));
      if (row.best[s]) best.push_back(names[s]);
    }
    line.push_back(fmt::format("{}", fmt::join(best, " ")));
  }
  return cells;
}

/// A column of the terminal's table: the best are marked in it.
std::vector<std::string> column_text(const std::vector<Row>& rows, const std::string& name, std::size_t s) {
  std::vector<std::string> column{name + " "};
  for (const Row& row : rows) column.push_back(number(row.medians[s]) + (row.best[s] ? "*" : " "));
  const std::size_t width = std::ranges::max(column, {}, &std::string::size).size();
  for (std::string& cell : column) cell = fmt::format(" {:>{}}", cell, width);
  return column;
}

/// As many columns side by side as fit, and the others below them.
std::string terminal_text(const std::vector<Row>& rows, const std::vector<std::string>& names) {
  std::vector<std::string> head{fmt::format("{:<21}", "median")};
  for (const Row& row : rows) head.push_back(fmt::format("{:<21}", row.metric));
  std::string text;
  for (std::size_t s = 0; s < names.size();) {
    std::vector<std::string> lines = head;
    for (bool fits = true; fits && s < names.size();) {
      const std::vector<std::string> column = column_text(rows, names[s], s);
      fits = lines[0].size() == head[0].size() || lines[0].size() + column[0].size() <= kTerminalWidth;
      for (std::size_t l = 0; fits && l < lines.size(); ++l) lines[l] += column[l];
      s += fits;
    }
    for (std::string& line : lines) text += line.erase(line.find_last_not_of(' ') + 1) + "\n";
    text += "\n";
  }
  return text +
         "* the best: others are worse by more than noise; normal and material are references and do not "
         "compete\n";
}

/// Which run is which, and in what they cannot be compared; nothing of one run alone.
std::string runs_text(const std::vector<Run>& runs, double end) {
  if (runs.size() < 2) return {};
  std::string text;
  for (std::size_t r = 0; r < runs.size(); ++r)
    text += fmt::format("{}: {} ({}, {} frame{} to t = {:.6g} s)\n", r + 1, runs[r].folder.string(),
                        runs[r].title, runs[r].frames(), runs[r].frames() == 1 ? "" : "s", runs[r].end());
  const auto differs = [&](const auto& value) {
    return std::ranges::any_of(runs, [&](const Run& run) { return value(run) != value(runs[0]); });
  };
  if (differs([](const Run& run) { return run.subject; }))
    text += "The runs are not of the same scene: what differs may be the liquid, not the surface.\n";
  if (differs([](const Run& run) { return run.end(); }))
    text += fmt::format("The runs are not of the same length: medians are over t <= {:.6g} s.\n", end);
  return text + "\n";
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

/// Whether there is anything to see.
bool changes(const Plot& plot) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Curve& curve : plot.curves)
    for (const Vec2& point : curve.points)
      if (!std::isnan(point.y())) least = std::min(least, point.y()), most = std::max(most, point.y());
  return least < most;
}

std::string last_name(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

/// What a run is called in plots: nothing where there is only one, else the last name of its path, or its
/// number where another has the same.
std::string plotted_name(const std::vector<Run>& runs, std::size_t r) {
  if (runs.size() < 2) return "";
  const std::string name = last_name(runs[r].folder);
  const auto has_name = [&](const Run& run) { return last_name(run.folder) == name; };
  return std::ranges::count_if(runs, has_name) > 1 ? fmt::format("{} ", r + 1) : name + " ";
}

/// An empty curve for each series; methods keep their colours where there is one run.
std::vector<Curve> named_curves(const std::vector<Run>& runs) {
  std::vector<Curve> curves;
  for (std::size_t r = 0; r < runs.size(); ++r)
    for (const Series& series : runs[r].series) {
      Curve& curve = curves.emplace_back(method_curve(series.method));
      if (runs.size() > 1) curve.style = static_cast<int>(curves.size() - 1) % kPlotStyles;
      curve.title = plotted_name(runs, r) + series.method;
    }
  return curves;
}

/// "tracer distance [sigma]".
std::string axis_label(std::string_view metric) {
  std::string label(metric);
  std::ranges::replace(label, '_', ' ');
  const MetricColumn* column = find_metric(metric);
  if (metric == kTime) return label + " [s]";
  return column == nullptr || column->unit == "1" ? label : fmt::format("{} [{}]", label, column->unit);
}

void write_plots(const fs::path& folder, const std::vector<Series>& all, const std::vector<Run>& runs) {
  const std::vector<Curve> curves = named_curves(runs);
  for (const Metric& metric : kMetrics) {
    const std::string name(metric.name);
    Plot plot{"", "t [s]", axis_label(name), {}};
    for (std::size_t s = 0; s < all.size(); ++s) {
      const std::vector<double> values = all[s].values(name);
      Curve curve = curves[s];
      for (std::size_t f = 0; f < values.size(); ++f) curve.points.emplace_back(all[s].times()[f], values[f]);
      if (!std::ranges::all_of(values, [](double value) { return std::isnan(value); }))
        plot.curves.push_back(std::move(curve));
    }
    if (changes(plot)) draw_plots(folder, name, {&plot, 1});
  }
}

void write_tables(const CompareOptions& options, const std::vector<Row>& rows, const std::string& runs,
                  const std::vector<std::string>& names) {
  const auto cells = cells_of(rows, names);
  std::string csv;
  for (const auto& row : cells) csv += fmt::format("{}\n", fmt::join(row, ","));
  write_file(options.folder / "compare.csv", csv);
  std::string list;
  std::istringstream lines(runs);
  for (std::string line; std::getline(lines, line);)
    list += line.empty() ? "\n" : fmt::format("- {}\n", line);
  write_file(options.folder / "compare.md", list + markdown_text(cells));
}

}  // namespace

std::string compare(const CompareOptions& options) {
  std::vector<Run> runs;
  for (const fs::path& folder : options.runs) runs.push_back(read_run(folder));
  std::vector<Series> all;
  std::vector<std::string> names, short_names;
  for (std::size_t r = 0; r < runs.size(); ++r)
    for (const Series& series : runs[r].series) {
      all.push_back(series);
      names.push_back(series.name(runs.size() > 1 ? runs[r].folder.string() : ""));
      short_names.push_back(series.name(runs.size() > 1 ? fmt::format("{}", r + 1) : ""));
    }
  const double end = std::ranges::min(runs, {}, &Run::end).end();
  std::vector<Row> rows;
  for (const Metric& metric : kMetrics) rows.push_back(row_of(all, metric, end));
  const std::string about = runs_text(runs, end);
  if (!options.folder.empty()) {
    require_gnuplot();
    make_folder(options.folder);
    write_tables(options, rows, about, names);
    write_plots(options.folder, all, runs);
  }
  return about + terminal_text(rows, short_names);
}

}  // namespace kappaflow
