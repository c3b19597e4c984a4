// run.json: what was run, so that it can be run again.
#pragma once

#include <vtk_jsoncpp_fwd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "tools/runs/run.h"
#include "tools/runs/scene_frames.h"
#include "tools/runs/track.h"
#include "tools/runs/track_input.h"

namespace kappaflow {

/// The text of run.json: version, build, command, options, scene (file, hash, text), threads, and the numbers
/// that were derived from the scene (threshold, sigma, frame count).
std::string run_record(const RunOptions& options, const Scene& scene, const SceneFrames& frames);

/// What the run.json of a run folder says. Throws IoError where it cannot be read or is something else.
Json::Value read_record(const std::filesystem::path& folder);

/// On how many processes a run is, how many of them share the liquid, and how, if that was said.
struct RunRanks {
  int all = 1, liquid = 1;
  std::vector<double> shares;
};
RunRanks ranks_of(const RunOptions& options, const SceneFrames& frames);

/// The record in a run folder, which says further that the run was resumed at `time` [s], and how.
std::string resumed_record(const std::filesystem::path& folder, const std::vector<std::string>& command,
                           int threads, const RunRanks& ranks, double time);

/// The same of tracked files: which, what is known about them, and the numbers that were derived.
std::string track_record(const TrackOptions& options, const TrackInput& tracked);

/// Date and time (UTC), as records and reports have them.
std::string time_now();

/// Compiler, build type and library versions, one a line.
std::string build_description();

}  // namespace kappaflow
