// The particles of another program's simulation, frame by frame.
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/io/file_series.h"
#include "tools/io/input_frames.h"
#include "tools/io/particle_frame.h"

namespace kappaflow {

/// Which particles of large frames are kept.
struct ParticleChoice {
  static constexpr std::size_t kMany = 10'000'000;

  bool all = false;               ///< whatever there are
  std::size_t many = kMany;       ///< in frames of more only those near the surface
  std::optional<double> sigma{};  ///< the field's support radius [m]; empty: two spacings
};

/// A series of particle files, checked when it is opened and then given frame by frame.
class ParticleSequence {
 public:
  /// What is known about the particles' velocities.
  enum class Velocity {
    given,      ///< the files have them
    estimated,  ///< from positions, paired by id
    unknown,    ///< there are neither velocities nor usable ids: the frames are point clouds
  };

  /// Reads every file, and keeps what it has read as InputFrames does. frames_per_second: where the files
  /// hold no times; the first one is then at 0 s. Throws what read_input_frame() throws, and InvalidInput
  /// where a file lacks an array that the first one has, times do not ascend, there are no times at all, or a
  /// file seems to be missing.
  /// watch: called before each file with its number from 0. choice: where the first or the last frame has
  /// that many particles, with velocities (or neither these nor ids) and of one radius, only those near the
  /// surface are kept of every frame, see read_near_surface().
  ParticleSequence(FileSeries series, std::optional<double> frames_per_second,
                   const std::function<void(std::size_t file)>& watch = {},
                   const ParticleChoice& choice = {});

  const FileSeries& series() const { return series_; }
  const std::string& name() const { return series_.name; }
  std::size_t size() const { return series_.files.size(); }
  const std::filesystem::path& file(std::size_t frame) const { return series_.files[frame]; }
  double time(std::size_t frame) const { return time_[frame]; }  ///< [s]
  /// Of the frame's files, whether they are kept or not.
  std::size_t particles_in(std::size_t frame) const { return particles_[frame]; }
  /// Of the frame and the one before: fast_speed() of all particles; where not all are kept [m/s].
  double fast_speed_to(std::size_t frame) const {
    return std::max(fast_speed_[frame - 1], fast_speed_[frame]);
  }
  /// Whether frames have all particles of their files.
  bool keeps_all() const { return keeps_all_; }
  /// Whether ids say which particle is which in the next frame.
  bool matched() const { return matched_; }
  Velocity velocity() const { return velocity_; }
  /// What a user should know about the files, a sentence or so each.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Of all that is read from the files, to recognise them by.
  const std::string& hash() const { return hash_; }

  /// Reads a frame, sorted by id. Backward its velocities have the other sign than in the file.
  /// Particles::scale is the radius over the median of the first frame. Where particles are not matched, ids
  /// are new in every frame. Estimated velocities are the derivative of the parabola through a particle's
  /// places in this frame and those before and after (at the ends of the sequence: the nearest three frames),
  /// of the line where it is in two of them; a particle that is in none but this is at rest.
  /// Of those in the depth that stand for others the scale is 3 or 6.
  ParticleFrame frame(std::size_t frame);
  /// Where not all are kept: the particles of a frame that those of the frame before go on to, ascending ids
  /// of which are `before`, and those that have come since; at the instant of frame(frame).
  Particles arrival(std::size_t frame, std::span<const std::int64_t> before);
  /// Where not all are kept: of the first frame those that stand for themselves, and the indices of those
  /// that have all their neighbours among them, none of them being near the surface.
  std::pair<std::vector<Vec3>, std::vector<std::uint32_t>> inside();

 private:
  ParticleFrame frame_of(std::size_t frame, std::span<const std::size_t> order);
  void choose(const ParticleChoice& choice);
  void estimate_velocities(std::size_t frame, Particles& particles);

  FileSeries series_;
  std::vector<double> time_;
  double radius_ = 0;  // median of the first frame, in the files' measure; 0: there are none
  std::vector<std::size_t> particles_;
  std::vector<double> fast_speed_;
  bool keeps_all_ = true;
  std::vector<std::size_t> first_id_;  // of each frame where particles are not matched
  bool matched_ = false;
  Velocity velocity_ = Velocity::unknown;
  std::vector<std::string> notes_;
  std::string hash_;
  InputFrames inputs_;
};

}  // namespace kappaflow
