// `kappaflow track`: tracks the surface of particles that another program wrote.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/field/particle_weights.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/particle_sequence.h"
#include "tools/runs/summary.h"

namespace kappaflow {

struct TrackOptions {
  std::vector<std::string> inputs;          ///< files, or shell patterns for them
  std::filesystem::path folder;             ///< empty: out/<name of the series>
  std::vector<std::string> methods;         ///< empty: material, or regional for point clouds
  std::optional<double> frames_per_second;  ///< where the files hold no times
  std::optional<double> sigma;              ///< support radius of Eq. 12 [m]; empty: 2 particle spacings
  std::optional<double> threshold;  ///< T of Eq. 12; empty: half the median of the field at the particles
  WeightRule weights = WeightRule::uniform;
  std::vector<MeshFormat> formats;  ///< of further mesh files beside each surface's .vtp
  int threads = 1;
  bool force = false;                ///< replace a run that the folder already holds
  bool quiet = false;                ///< no progress, no summary
  std::vector<std::string> command;  ///< the command line, for run.json
};

/// Tracks a sequence and writes a run folder. The files are all read and checked before anything is written;
/// SIGINT and SIGTERM end it after the current step. Returns the exit code: 0, or 130 or 143 after a signal.
int track(const TrackOptions& options);

}  // namespace kappaflow
