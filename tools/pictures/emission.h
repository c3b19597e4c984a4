// When liquid that flows in came into a run.
#pragma once

#include <vtkPolyData.h>

#include <cstdint>
#include <filesystem>
#include <unordered_map>

#include "tools/io/input_frames.h"
#include "tools/pictures/run_frames.h"

namespace kappaflow {

inline constexpr const char* kEmissionTimeArray = "emission_time";

/// Whether the last frame has particles that the first one lacks, as far as there are files that say so.
bool is_fed(const RunFrames& frames);

/// When each particle of a run came into it.
class EmissionTimes {
 public:
  /// Reads the particles of frames 0 to `last`. Of those that a frame is the first to have, the times lie
  /// between it and the one before, in the order of their ids. Throws IoError, InvalidInput (without ids).
  EmissionTimes(const RunFrames& frames, int last);

  /// Gives the frame's surface the point array emission_time [s]: that of the nearest particle.
  void add_to(vtkPolyData& surface, int frame) const;

 private:
  const InputFrame& particles(int frame) const;

  std::filesystem::path folder_;
  mutable InputFrames frames_;                     // surfaces of one frame ask for it one after the other
  std::unordered_map<std::int64_t, double> time_;  // [s] of a particle's id
};

}  // namespace kappaflow
