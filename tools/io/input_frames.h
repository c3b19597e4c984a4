// The frames of a series of particle files: the first ones stay in memory, as many as fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <vector>

#include "tools/io/file_series.h"
#include "tools/io/input_frame.h"

namespace kappaflow {

/// Reads frames when they are asked for, and, of those in a row, the next one beside what else is done. The
/// first to be read stay in memory, up to a limit; of the others only those read last do. So who goes through
/// a series twice, to check it and to use it, reads each file once where the series fits.
class InputFrames {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;
  static constexpr std::size_t kWindow = 3;      // for velocities that are estimated
  static constexpr std::size_t kNearWindow = 2;  // of particles near the surface

  /// Where the series is backward velocities have the other sign than in the files. limit: for the frames
  /// that stay [bytes].
  InputFrames(FileSeries series, std::size_t limit = kMostBytes);

  const FileSeries& series() const { return series_; }

  /// From now on only particles near the surface are kept, see read_near_surface(). sigma: support radius of
  /// the field [m].
  void keep_near_surface(double sigma) { sigma_ = sigma; }

  /// The frame, valid until kWindow others have been asked for. Throws what read_input_frame() throws.
  const InputFrame& operator[](std::size_t frame);

  /// Frames before this one are not asked for again soon: those that do not stay go.
  void forget_before(std::size_t frame) {
    std::erase_if(last_, [&](const auto& of_frame) { return of_frame.first < frame; });
  }

 private:
  InputFrame read(std::size_t frame);
  bool is_here(std::size_t frame) const { return kept_.contains(frame) || last_.contains(frame); }
  void read_ahead(std::size_t frame);
  std::vector<std::int64_t> ids_before(std::size_t frame);

  FileSeries series_;
  double sigma_ = 0;                        // 0: all particles are kept
  std::size_t room_;                        // left for frames that stay [bytes]
  std::map<std::size_t, InputFrame> kept_;  // for good
  std::map<std::size_t, InputFrame> last_;  // those read last, at most kWindow
  std::future<InputFrame> ahead_;           // of the frame number_ahead_, where it is valid
  std::size_t number_ahead_ = 0, last_read_ = 0;
};

}  // namespace kappaflow
