// metrics.csv: its columns, in one table for everybody who writes, reads, compares or documents them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/measure/surface_metrics.h"

namespace kappaflow {

/// Numbers that all methods of a frame share.
struct FrameMetrics {
  int frame = 0;
  double time = 0;  ///< [s]
  std::size_t particles = 0;
  std::optional<double> penetration_max;     ///< deepest particle centre inside a solid, in spacings; >= 0
  std::optional<double> density_error_mean;  ///< largest mean compression of a step since the last frame [1]
  std::optional<double> density_error_max;   ///< largest compression of a particle since then [1]
  std::optional<double> viscosity_error;     ///< largest of a step since then, over what is tolerated [1]
  std::optional<double> temperature_min, temperature_mean, temperature_max;  ///< of the particles [K]
  std::optional<IsosurfaceMetrics> isosurface;  ///< where the frame's surfaces are judged
  std::size_t particles_outside = 0;            ///< see points_outside()
  std::size_t particles_taken = 0;              ///< by outflow regions since the start
  std::string taken_by_region;  ///< the same by region, see taken_text(); empty: there are none
};

/// Counts in the order of the regions with spaces between them, as a cell of metrics.csv has them.
std::string taken_text(std::span<const std::size_t> taken);

/// A row of the table: one method at one frame.
struct MetricsRow {
  FrameMetrics frame;
  std::string method;
  SurfaceMetrics surface;  ///< `pieces` have a table of their own
};

/// Which of two values of a metric is the better one.
enum class Better { neither, lower, higher, nearer_to_one };

/// A column of metrics.csv.
struct MetricColumn {
  std::string_view name, unit, meaning;  ///< as docs/outputs.md has them
  Better better;
  std::string (*cell)(const MetricsRow& row);  ///< numbers to 12 digits; empty where there is no value
  double (*number)(const MetricsRow& row);     ///< nan where there is none
  void (*read)(std::string_view cell, MetricsRow& row);  ///< throws InvalidInput
};

/// All of them, in the order of the file.
std::span<const MetricColumn> metric_columns();
/// Null where no column has that name.
const MetricColumn* find_metric(std::string_view name);

/// One line each, with the line's end.
std::string metrics_header();
std::string metrics_row(const MetricsRow& row);

/// What a metrics.csv says, to the digits that it has.
struct MetricsTable {
  std::vector<const MetricColumn*> columns;  ///< that the file has
  std::vector<MetricsRow> rows;
};
/// Of any version: columns that this one does not know are passed over, those that the file lacks keep their
/// defaults. Throws IoError where the file cannot be read or is something else.
MetricsTable read_metrics_table(const std::filesystem::path& file);
/// The rows of a file with the columns of this version. Throws IoError where it has others too.
std::vector<MetricsRow> read_metrics(const std::filesystem::path& file);

/// The same of pieces.csv: a line for each connected piece.
std::string pieces_header();
std::string pieces_rows(const MetricsRow& row);

}  // namespace kappaflow
