// What `kappaflow run` and `kappaflow track` print at their end.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/runs/metrics.h"
#include "tools/runs/timings.h"

namespace kappaflow {

/// One method over the whole run.
struct MethodSummary {
  std::string name;
  std::vector<SurfaceMetrics> frames;   ///< without their `pieces`, of which there may be many
  PhaseSeconds seconds;                 ///< summed over the frames that RunSummary times
  std::vector<double> surface_seconds;  ///< PhaseSeconds::surface() of those, but for the first mesh's

  double residual_max() const;                 ///< largest of all frames [sigma]
  std::optional<double> time_a_frame() const;  ///< median of surface_seconds [s]

  void add_frame(const std::string& method, const SurfaceMetrics& metrics);
  /// Of the frame added last.
  void add_seconds(const PhaseSeconds& frame_seconds);
};

/// The whole run.
struct RunSummary {
  std::vector<MethodSummary> methods;
  std::vector<FrameMetrics> frames;  ///< the finished ones, the first included
  /// The largest of all frames.
  std::optional<double> penetration_max, density_error_mean, density_error_max, viscosity_error;
  double density_tolerance = 0;   ///< of the liquid's solver [1]
  std::size_t steps = 0;          ///< in time
  std::size_t frames_before = 0;  ///< frames that were there when the run was resumed, which are not timed
  double setup_seconds = 0, tracer_seconds = 0, shared_output_seconds = 0;
  double wall_seconds = 0;
  int interrupted_by = 0;     ///< the signal; 0: none
  double interrupted_at = 0;  ///< [s] of simulated time
  std::string text;           ///< see summary_text()

  void add_frame(const FrameMetrics& metrics, double tracers, double shared_output);
  /// The frames that a resumed run finds in its table; without the wall times.
  void add_frames_before(std::span<const MetricsRow> rows);
};

/// The upper median over the frames that have a value; nullopt where none has. Rotation captured is a ratio,
/// and one frame in which the material hardly turns would spoil a mean.
std::optional<double> median_over(std::span<const SurfaceMetrics> frames,
                                  std::optional<double> SurfaceMetrics::*member);

/// For the terminal. field: what the surfaces are of, e.g. "threshold 0.5, sigma 0.1 m".
std::string summary_text(const RunSummary& summary, const std::string& title, const std::string& field,
                         const std::filesystem::path& folder);

}  // namespace kappaflow
