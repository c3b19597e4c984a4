// When the frames of a series of files are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/io/file_series.h"

namespace kappaflow {

/// The times of a series: of the list that names its files, else those in the files, else by frames a second.
/// Backward they are those before the last file's, from 0 s on.
class FrameTimes {
 public:
  /// series: must outlive this.
  explicit FrameTimes(const FileSeries& series) : series_(&series) {}

  /// What the next file says. Throws InvalidInput where it says a time and the first one does not, or the
  /// other way round, and where times do not ascend.
  void add(std::optional<double> in_file);

  /// Once all files are added: throws InvalidInput where there are no times and a file is missing.
  void check_gap() const;
  /// The same: whether somebody has said them.
  bool known() const { return time_.front().has_value(); }
  /// The time of each frame [s]; by frames a second, and backward, the first one is at 0 s. rate: what is
  /// known of frames a second where nobody has said it, for the message. Throws InvalidInput where there are
  /// no times at all.
  std::vector<double> times(std::optional<double> frames_per_second, const std::string& rate = {}) const;
  /// What a user should know about the times, a sentence or so each.
  std::vector<std::string> notes(std::optional<double> frames_per_second) const;

 private:
  const FileSeries* series_;
  std::vector<std::optional<double>> time_;
};

}  // namespace kappaflow
