// `kappaflow run`: simulates a scene, tracks its surface, and writes the run folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "surface/motion/velocity.h"
#include "tools/interrupt.h"
#include "tools/mesh_text.h"
#include "tools/summary.h"

namespace kappaflow {

struct RunOptions {
  std::filesystem::path scene;
  std::filesystem::path folder;        ///< empty: out/<name of the scene file>
  std::vector<std::string> methods;    ///< empty: those of the scene
  std::optional<double> duration;      ///< instead of the scene's [s]
  std::optional<Minimiser> minimiser;  ///< instead of the scene's
  bool keep_connectivity = false;      ///< no remeshing, whatever the scene says
  std::vector<MeshFormat> formats;     ///< of further mesh files beside each surface's .vtp
  int threads = 1;
  bool force = false;                ///< replace a run that the folder already holds
  bool quiet = false;                ///< no progress, no summary
  std::vector<std::string> command;  ///< the command line, for run.json
};

/// Runs a scene and writes its folder; an interrupt (SIGINT) ends it after the current step.
RunSummary run_scene(const RunOptions& options);

/// The same, saying what became of it. Returns the exit code: 0, or 130 after an interrupt.
int run(const RunOptions& options);

}  // namespace kappaflow
