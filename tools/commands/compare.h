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

/// A table with a row for each metric, its median for each method of each run over the frames up to the end
/// of the shortest run, and the methods that do best (where a metric has a best, and they are better than
/// others by more than noise; `normal` and `material` are what the others are measured against, and never
/// best). It says where the runs differ in scene or length. With a folder also compare.csv, compare.md and a
/// plot over time for each metric. Returns the text for the terminal, 120 columns wide at most. Throws
/// IoError where a folder holds no run.json or metrics.csv or a file cannot be written.
std::string compare(const CompareOptions& options);

}  // namespace kappaflow
