// What the first reading of a series of particle files finds out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/text_hash.h"
#include "core/types.h"
#include "tools/io/file_series.h"
#include "tools/io/frame_times.h"
#include "tools/io/input_frames.h"

namespace kappaflow {

/// Particles that are exactly where others are: how many, and the first two in one place.
struct Coincidence {
  std::size_t count = 0;
  std::size_t first = 0, second = 0;
};
Coincidence coincident_particles(std::span<const Vec3> position);

/// Particles of two frames, by their indices in both.
using IndexPairs = std::span<const std::pair<std::size_t, std::size_t>>;

/// How far particles move between frames, beside what their velocities say.
struct Displacements {
  double along_velocity = 0;  // sum of displacement . velocity [m2/s]
  double velocity2 = 0;       // sum of |velocity|^2 [m2/s2]
  double displacement2 = 0;   // sum of |displacement|^2 [m2]

  void add(const InputFrame& before, const InputFrame& after, IndexPairs pairs);

  bool any_motion() const { return along_velocity > 0; }
  double frames_per_second() const { return velocity2 / along_velocity; }  // by least squares
  /// Share of the displacements that velocities account for, in [0, 1].
  double agreement() const { return along_velocity * along_velocity / (velocity2 * displacement2); }
};

/// What the first reading of all files finds out.
struct ParticleSurvey {
  explicit ParticleSurvey(const FileSeries& series) : times(series) {}

  FrameTimes times;
  std::vector<std::size_t> particles;
  std::vector<double> fast_speed;
  Displacements displacements;
  std::string repeated;    // where an id is used twice; empty: nowhere
  std::string wrong_ids;   // where ids do not follow the particles; empty: nowhere
  std::string coincident;  // where particles are in the places of others; empty: nowhere
  std::string id_name, velocity_name, radius_name;
  double radius = 0, smallest = 0, largest = 0;  // median of the first frame; range over all
  std::size_t left_out = 0, kept = 0;
  TextHash hash;

  void add_radii(std::vector<double> radii);
};

/// Reads every file. watch: called before each with its number from 0. Throws what reading does, and
/// InvalidInput where a file lacks an array that the first one has.
ParticleSurvey survey(InputFrames& frames, const FileSeries& series,
                      const std::function<void(std::size_t file)>& watch);

}  // namespace kappaflow
