// Wall times, and the numbers of timings.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "surface/tracker/surface_tracker.h"

namespace kappaflow {

/// Wall time of one method between two frames, or of a whole run [s]. The fields that all methods share are
/// evaluated when the first method asks for them, so they count to its velocity.
struct PhaseSeconds {
  double solver = 0;    ///< the liquid; the same for every method
  double velocity = 0;  ///< velocities and advection
  double fairing = 0;   ///< fairing and projection
  double topology = 0;  ///< changes of the mesh's topology, or a fresh mesh
  double remesh = 0;    ///< edits of the mesh
  double texture = 0;   ///< textures that no vertex carries along
  double output = 0;    ///< metrics and files

  /// Of the surface alone.
  double surface() const { return velocity + fairing + topology + remesh + texture; }
};

/// Those of a surface's steps, and what else there is to say.
PhaseSeconds phase_seconds(const TrackerStep& steps, double solver, double output);

/// The physical memory that the program holds [MiB].
double resident_memory();

/// One line each, with the line's end; times in milliseconds, memory in MiB.
std::string timings_header();
std::string timings_row(int frame, double time, const std::string& method, const PhaseSeconds& seconds,
                        double memory);

/// What a row says of the surface alone: PhaseSeconds::surface().
struct SurfaceTime {
  int frame = 0;
  std::string method;
  double seconds = 0;
};
/// The rows of a timings.csv of any version: times that it lacks count as none. Empty where there is no such
/// file. Throws IoError where it is something else.
std::vector<SurfaceTime> read_surface_times(const std::filesystem::path& file);

}  // namespace kappaflow
