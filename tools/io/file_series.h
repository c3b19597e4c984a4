// Files whose names differ in one number: the frames of a simulation.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kappaflow {

/// The files of one series in the order of their numbers (2 before 10).
struct FileSeries {
  std::vector<std::filesystem::path> files;
  std::string name;         ///< what the files' names have in common before the number, for titles
  double step = 1;          ///< by how much the number goes up, mostly
  bool is_decimal = false;  ///< whether it has places after the point, as times have
  std::string gap;          ///< empty, or where the number goes up by another step, as a sentence
};

/// Expands names and shell patterns (*, ?, [...], ~); folders that are there may have these characters in
/// their names. Throws IoError where nothing matches, InvalidInput where there are fewer than two files, or
/// they are not one series: their names must differ in one number, whole or decimal, and nothing else.
FileSeries file_series(std::span<const std::string> patterns);

}  // namespace kappaflow
