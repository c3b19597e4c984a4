// A run from frame to frame and from checkpoint to checkpoint, whatever its frames come from.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "tools/runs/frame_source.h"
#include "tools/runs/frame_writer.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/saved_run.h"

namespace kappaflow {

/// What there is to know of a run beside where its frames come from and go to.
struct RunSettings {
  std::string command;  ///< of kappaflow: run or track
  std::string title;    ///< for the summary
  OutputDescription output;
  std::vector<std::string> methods;  ///< what files and tables call the surfaces
  std::vector<MeshFormat> formats;   ///< of files for other programs, beside .vtp
  double density_tolerance = 0;      ///< of the liquid's solver [1]
  bool quiet = false;                ///< no progress
  /// What a checkpoint begins with, after the command.
  std::function<void(StateWriter&)> save_beginning;
};

/// Takes frames from a source, writes them, and checkpoints between them; says how far it is, and how to go
/// on after a signal or an error.
class RunDriver {
 public:
  /// Before the source's first step. watch: runs since the set-up began. source, folder: must outlive it.
  RunDriver(FrameSource& source, RunFolder& folder, RunSettings settings, const Stopwatch& watch);
  RunDriver(const RunDriver&) = delete;  // its writer refers to its settings
  RunDriver& operator=(const RunDriver&) = delete;

  /// Writes frame 0 and a checkpoint: from then on the folder is the run's own.
  void start();
  /// Goes on from where a run was at `frame`, with what is left of its checkpoint.
  void restore(int frame, SavedRun& saved);
  /// To the last frame or until a signal comes, with a checkpoint every checkpoint_interval frames and at the
  /// end. An IoError that leaves a step also says how to go on, any other Error of one where the particles
  /// are.
  RunSummary advance(const InterruptGuard& guard);

  /// See core/saved_state.h; for a run that has not started.
  template <class Archive>
  void serialize(Archive& archive) {
    if constexpr (Archive::is_loading::value)
      source_.read_state(archive);
    else
      source_.write_state(archive);
    archive(writer_, folder_);
  }

 private:
  void advance_frames(const InterruptGuard& guard);
  bool go_to(int frame, const FrameSource::Watch& watch);
  void write_frame(int frame);
  void write_checkpoint();
  std::string kept_particles() const;

  FrameSource& source_;
  RunFolder& folder_;
  RunSettings settings_;
  Stopwatch watch_;
  FrameWriter writer_;
  int frame_ = 0;  // the last one written
  RunSummary summary_;
};

/// Says what became of a run: on stdout unless `quiet`, and on stderr how to go on with one that was
/// interrupted. Returns the exit code: 0, or 130 or 143 after a signal.
int run_outcome(const RunSummary& summary, const std::string& command, const std::filesystem::path& folder,
                bool quiet);

/// The summary of a run that is complete already: a text, and nothing else. frame: the last one.
RunSummary complete_run(const std::filesystem::path& folder, int frame);

}  // namespace kappaflow
