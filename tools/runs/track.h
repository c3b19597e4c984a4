// `kappaflow track`: tracks the surface of particles that another program wrote, or surfaces that it has as
// images of their distance or as meshes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/saved_state.h"
#include "surface/field/kernel_shapes.h"
#include "surface/field/particle_weights.h"
#include "surface/measure/texture.h"
#include "surface/tracker/surface_methods.h"
#include "tools/io/file_series.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/particle_sequence.h"

namespace kappaflow {

struct TrackOptions {
  /// Files, patterns for them, a folder or a .pvd, see file_series(); of a run that is resumed: empty where
  /// they are where they were.
  std::vector<std::string> inputs;
  FileRange range;                          ///< which of them, and whether backward
  std::filesystem::path resume;             ///< folder of an interrupted run to go on with; empty: a new run
  std::filesystem::path folder;             ///< empty: out/<name of the series>
  std::vector<std::string> methods;         ///< empty: material, or regional for point clouds
  std::optional<double> frames_per_second;  ///< where the files hold no times
  std::optional<double> sigma;      ///< support radius of Eq. 12 [m]; empty: usual_sigma() particle spacings
  std::optional<double> threshold;  ///< T of Eq. 12; empty: half the median of the field at the particles
  WeightRule weights = WeightRule::uniform;
  Kernels kernels = Kernels::round;
  std::optional<double> edge_length;  ///< of the mesh where it is flat [m]; empty: a quarter of sigma
  std::size_t many_particles =
      ParticleChoice::kMany;           ///< in larger frames only those near the surface are kept
  std::optional<double> checker_edge;  ///< of the checker's cubes [m]; empty: OutputDescription's
  TextureProjection texture = TextureProjection::box;
  Anchor anchor = Anchor::none;     ///< see SurfaceOptions
  int rest_interval = 0;            ///< see OutputDescription
  int metrics_interval = 10;        ///< see OutputDescription
  std::vector<MeshFormat> formats;  ///< of files for other programs, beside .vtp
  int threads = 1;
  bool force = false;                ///< replace a run that the folder already holds
  bool quiet = false;                ///< no progress, no summary
  std::vector<std::string> command;  ///< the command line, for run.json

  /// See core/saved_state.h: what a resumed run takes over.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(range, methods, frames_per_second, sigma, threshold, weights, kernels, edge_length,
            many_particles, checker_edge, texture, anchor, rest_interval, metrics_interval, formats);
  }
};

/// Tracks a sequence and writes a run folder, with a checkpoint after every frame; or goes on with a run from
/// its last frame as if it had never stopped: all files but run.json and timings.csv are the same bits. The
/// files are all read and checked before anything is written. SIGINT and SIGTERM end it after the current
/// step. Returns the exit code: 0, or 130 or 143 after a signal. Throws InvalidInput for files that are not
/// those that the run began with.
int track(const TrackOptions& options);

}  // namespace kappaflow
