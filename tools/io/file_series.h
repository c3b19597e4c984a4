// Files whose names differ in one number: the frames of a simulation.
#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace kappaflow {

/// Which of the files: those with numbers in [first, last], every stride-th of them; and in which order.
struct FileRange {
  double first = 0, last = std::numeric_limits<double>::infinity();
  int stride = 1;         ///< >= 1
  bool backward = false;  ///< from the last one to the first

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(first, last, stride, backward);
  }
};

/// The files of one series in the order of their numbers (2 before 10), or backward. Who reads them backward
/// in time counts it from the last file on, and changes the sign of velocities.
struct FileSeries {
  std::vector<std::filesystem::path> files;
  std::vector<double> times;  ///< of each file [s] where a .pvd says them; else empty
  std::string name;           ///< what the files' names have in common before the number, for titles
  double step = 1;            ///< by how much the number goes up from file to file of the series, mostly
  int stride = 1;             ///< see FileRange
  bool is_decimal = false;    ///< whether it has places after the point, as times have
  bool backward = false;      ///< see FileRange
  std::string gap;            ///< empty, or where the number goes up by another step, as a sentence

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    std::vector<std::string> names(files.begin(), files.end());
    archive(names, times, name, step, stride, is_decimal, backward, gap);
    files.assign(names.begin(), names.end());
  }
};

/// Expands names and shell patterns (*, ?, [...], ~); folders that are there may have these characters in
/// their names. A folder stands for the files in it that may be frames, see is_input_file(), a .pvd for the
/// files that it lists, whose numbers count from 0. Throws IoError where nothing matches, InvalidInput where
/// there are fewer than two files, or they are not one series: their names must differ in one number, whole
/// or decimal, and nothing else.
FileSeries file_series(std::span<const std::string> patterns, const FileRange& range = {});

}  // namespace kappaflow
