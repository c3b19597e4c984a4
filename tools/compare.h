// `kappaflow compare`: the metrics of one or more run folders side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

struct CompareOptions {
  std::vector<std::filesystem::path> runs;  ///< run folders
  std::filesystem::path folder;             ///< empty: the table is printed, and nothing written
};

/// A table with a row for each metric, its median over the frames for each method of each run, and the
/// methods that do best (where a metric has a best). With a folder also compare.csv, compare.md and a plot
/// over time for each metric. Returns the table for the terminal. Throws IoError where a folder holds no
/// metrics.csv or a file cannot be written.
std::string compare(const CompareOptions& options);

}  // namespace kappaflow
