// What `kappaflow run` prints at its end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "tools/metrics.h"
#include "tools/timings.h"

namespace kappaflow {

/// One method over the whole run.
struct MethodSummary {
  std::string name;
  SurfaceMetrics last;            ///< of the last frame
  double residual_max = 0;        ///< largest of all frames [sigma]
  std::vector<double> slips;      ///< of the frames that have one
  std::vector<double> rotations;  ///< likewise
  PhaseSeconds seconds;           ///< summed over the frames

  void add_frame(const std::string& method, const SurfaceMetrics& metrics, const PhaseSeconds& frame_seconds);
};

/// The whole run.
struct RunSummary {
  std::vector<MethodSummary> methods;
  FrameMetrics last;
  double penetration_max = 0, density_error_mean = 0, density_error_max = 0;  ///< largest of all frames
  int frames = 0;         ///< finished ones, the first included
  std::size_t steps = 0;  ///< of the solver
  double setup_seconds = 0, tracer_seconds = 0, shared_output_seconds = 0;
  double wall_seconds = 0;

  void add_frame(const FrameMetrics& metrics, double tracers, double shared_output);
};

std::string summary_text(const RunSummary& summary, const Scene& scene, const ParticleFieldOptions& field,
                         const std::filesystem::path& folder);

}  // namespace kappaflow
