// Files whose names differ in one number, or in that of a rank beside: the frames of a simulation.
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
  std::vector<std::filesystem::path> files;  ///< one a frame: of its pieces the first
  /// Of each frame all its pieces, in the order of their ranks; empty where each frame is one file.
  std::vector<std::vector<std::filesystem::path>> pieces;
  std::vector<double> times;  ///< of each file [s] where a .pvd says them; else empty
  std::string name;           ///< what the files' names have in common before the number, for titles
  double step = 1;            ///< by how much the number goes up from file to file of the series, mostly
  int stride = 1;             ///< see FileRange
  bool is_decimal = false;    ///< whether it has places after the point, as times have
  bool backward = false;      ///< see FileRange
  std::string gap;            ///< empty, or where the number goes up by another step, as a sentence

  /// All files of a frame.
  std::span<const std::filesystem::path> files_of(std::size_t frame) const {
    return pieces.empty() ? std::span(&files[frame], 1) : std::span(pieces[frame]);
  }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    std::vector<std::string> names(files.begin(), files.end());
    std::vector<std::vector<std::string>> piece_names;
    for (const auto& of_frame : pieces) piece_names.emplace_back(of_frame.begin(), of_frame.end());
    archive(names, piece_names, times, name, step, stride, is_decimal, backward, gap);
    files.assign(names.begin(), names.end());
    pieces.clear();
    for (const auto& of_frame : piece_names) pieces.emplace_back(of_frame.begin(), of_frame.end());
  }
};

/// Expands names and shell patterns (*, ?, [...], ~); folders that are there may have these characters in
/// their names. A folder stands for the files in it that may be frames, see is_input_file(), or for the
/// .pvtp, .pvtu or .pvti alone where there are any; a .pvd for the files that it lists, whose numbers count
/// from 0: the first of a time, with the parts of that time that have the same name and whose files' names
/// differ from its in numbers only. Throws IoError where nothing matches, InvalidInput where there are fewer
/// than two frames, or they are not one series: their names must differ in one number, whole or decimal, and
/// nothing else but the number of a rank, which stands behind rank, proc, process, processor, piece, domain,
/// cpu or mpi; each frame must have the same ranks.
FileSeries file_series(std::span<const std::string> patterns, const FileRange& range = {});

}  // namespace kappaflow
