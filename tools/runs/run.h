// `kappaflow run`: simulates a scene, tracks its surface, and writes the run folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "solver/ranks.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/particle_sequence.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/summary.h"

namespace kappaflow {

struct RunOptions {
  std::filesystem::path scene;       ///< empty where a run is resumed: the copy in its folder
  std::filesystem::path resume;      ///< folder of an interrupted run to go on with; empty: a new run
  std::filesystem::path folder;      ///< empty: out/<name of the scene file>
  std::vector<std::string> methods;  ///< empty: those of the scene
  std::optional<double> duration;    ///< instead of the scene's [s]
  bool keep_connectivity = false;    ///< no remeshing, whatever the scene says
  std::vector<MeshFormat> formats;   ///< of files for other programs, beside .vtp
  int threads = 1;
  bool force = false;                        ///< replace a run that the folder already holds
  bool quiet = false;                        ///< no progress, no summary
  std::vector<std::string> command;          ///< the command line, for run.json
  Ranks* ranks = nullptr;                    ///< that share the liquid, this being one of them
  std::size_t many = ParticleChoice::kMany;  ///< of more particles surfaces apart are told of those near them
  std::optional<int> surface_ranks;          ///< for tests: that follow surfaces; else ranks_for_surfaces()

  /// See core/saved_state.h: what a resumed run takes over.
  template <class Archive>
  void serialize(Archive& archive) {
    std::string file = scene.string();
    archive(file, methods, duration, keep_connectivity, formats);
    scene = file;
  }
};

/// Runs a scene and writes its folder, or goes on with a run as if it had never stopped: all files but
/// run.json and timings.csv are the same bits. After every OutputDescription::checkpoint_interval frames, and
/// when SIGINT or SIGTERM ends the run after the current step, it writes a checkpoint to go on from. The
/// summary of a run that is complete already has a text, and nothing else.
///
/// Throws InvalidInput for a scene that is not the one that the run began with. Where a simulation fails, its
/// particles are written for inspection.
RunSummary run_scene(const RunOptions& options);

/// What the ranks above 0 do: their part of the liquid or of the surfaces, until the first one is through.
void follow_run(const RunOptions& options);

/// The same, saying what became of it. Returns the exit code: 0, or 130 or 143 after a signal.
int run(const RunOptions& options);

}  // namespace kappaflow
