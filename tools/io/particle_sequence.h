// The particles of another program's simulation, frame by frame.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/io/file_series.h"
#include "tools/io/input_frames.h"
#include "tools/io/particle_frame.h"

namespace kappaflow {

/// Particles that are exactly where others are: how many, and the first two in one place.
struct Coincidence {
  std::size_t count = 0;
  std::size_t first = 0, second = 0;
};
Coincidence coincident_particles(std::span<const Vec3> position);

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
  /// watch: called before each file with its number from 0.
  ParticleSequence(FileSeries series, std::optional<double> frames_per_second,
                   const std::function<void(std::size_t file)>& watch = {});

  const FileSeries& series() const { return series_; }
  const std::string& name() const { return series_.name; }
  std::size_t size() const { return series_.files.size(); }
  const std::filesystem::path& file(std::size_t frame) const { return series_.files[frame]; }
  double time(std::size_t frame) const { return time_[frame]; }  ///< [s]
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
  ParticleFrame frame(std::size_t frame);

 private:
  void estimate_velocities(std::size_t frame, Particles& particles);

  FileSeries series_;
  std::vector<double> time_;
  double radius_ = 0;                  // median of the first frame, in the files' measure; 0: there are none
  std::vector<std::size_t> first_id_;  // of each frame where particles are not matched
  bool matched_ = false;
  Velocity velocity_ = Velocity::unknown;
  std::vector<std::string> notes_;
  std::string hash_;
  InputFrames inputs_;
};

}  // namespace kappaflow
