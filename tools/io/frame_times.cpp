#include "tools/io/frame_times.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace kappaflow {

void FrameTimes::add(std::optional<double> in_file) {
  const std::size_t k = time_.size();
  const std::vector<std::filesystem::path>& files = series_->files;
  const std::optional<double> time = series_->times.empty() ? in_file : series_->times[k];
  if (k > 0 && time.has_value() != known())
    throw InvalidInput({files[k].string()}, fmt::format("{} a time; {} {}", time ? "holds" : "lacks",
                                                        files.front().string(), time ? "does not" : "does"));
  if (k > 0 && time) {
    const std::size_t later = series_->backward ? k - 1 : k;  // in the order of the names
    const double after = later == k ? *time : *time_.back(), before = later == k ? *time_.back() : *time;
    if (!(after > before))
      throw InvalidInput(
          {files[later].string()},
          fmt::format("its time, {} s, is not after that of the file before, {} s", after, before));
  }
  time_.push_back(time);
}

void FrameTimes::check_gap() const {
  if (!known() && !series_->gap.empty())
    throw InvalidInput(fmt::format("{}; files without times must be equally far apart", series_->gap));
}

std::vector<double> FrameTimes::times(std::optional<double> frames_per_second,
                                      const std::string& rate) const {
  std::vector<double> times;
  for (std::size_t k = 0; k < time_.size(); ++k) {
    if (!time_[k] && !frames_per_second)
      throw InvalidInput(fmt::format(
          "{}: the files hold no times; say how many frames a second they are by --fps{}", series_->name,
          rate.empty() && series_->is_decimal
              ? fmt::format(" ({:.6g} if the names hold seconds)", 1 / series_->step)
              : rate));
    if (!time_[k])
      times.push_back(static_cast<double>(k) * series_->stride / *frames_per_second);
    else
      times.push_back(series_->backward ? *time_.front() - *time_[k] : *time_[k]);
  }
  return times;
}

std::vector<std::string> FrameTimes::notes(std::optional<double> frames_per_second) const {
  const std::vector<double> time = times(frames_per_second);
  std::vector<std::string> notes;
  notes.push_back(fmt::format("times {} to {:.6g} s, {}", time.front(), time.back(),
                              !series_->times.empty() ? std::string("from the .pvd")
                              : known()               ? std::string("from the files")
                                        : fmt::format("{} frames a second", *frames_per_second)));
  if (series_->backward)
    notes.push_back(
        fmt::format("backward from {}{}", series_->files.front().string(),
                    known() ? fmt::format(", which is at {:.6g} s", *time_.front()) : std::string()));
  if (!known() && series_->step != 1)
    notes.push_back(fmt::format("numbers go up by {:.6g}: taken as consecutive frames, {:.4g} s apart",
                                series_->step, 1 / *frames_per_second));
  if (known() && frames_per_second) notes.emplace_back("--fps is not used: the files hold times");
  if (!series_->gap.empty()) notes.push_back(series_->gap);
  return notes;
}

}  // namespace kappaflow
