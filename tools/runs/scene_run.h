// A run of a scene, from frame to frame and from checkpoint to checkpoint.
#pragma once

#include <string>

#include "core/stopwatch.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/run.h"
#include "tools/runs/run_writer.h"

namespace kappaflow {

/// The times of a scene's frames [s]. Frame 0 is the start; the last one falls on the duration even where
/// that is no multiple of the frame time.
struct FrameTimes {
  explicit FrameTimes(const Scene& scene);
  double operator[](int frame) const;

  int count;  ///< number of the last frame
  double frames_per_second, duration;
};

/// What a run was begun with, and how far it is: what a checkpoint begins with.
struct RunPoint {
  RunOptions options;
  std::string scene_hash;  ///< PreparedScene::hash
  int frame = 0;           ///< the last one written

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(options, scene_hash, frame);
  }
};

/// A run between two steps: all that the files to come depend on.
class SceneRun {
 public:
  /// Makes the simulation. folder: must outlive it.
  SceneRun(const RunPoint& point, PreparedScene prepared, RunFolder& folder);

  /// Writes frame 0 and a checkpoint: from then on the folder is the run's own.
  void start();
  /// Advances to the scene's end or until a signal comes, with a checkpoint (the RunPoint and this) every
  /// checkpoint_interval frames and at the end. An IoError that leaves it also says how to go on, any other
  /// Error where the particles are.
  RunSummary advance(const InterruptGuard& guard);

  const Scene& scene() const { return scene_; }
  const Simulation& simulation() const { return simulation_; }

  /// See core/saved_state.h; for a run of the same scene that has not started.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(simulation_, writer_, folder_);
    if constexpr (Archive::is_loading::value) restore_frames();
  }

 private:
  void advance_frames(const InterruptGuard& guard);
  void write_frame(int frame);
  void write_checkpoint();
  void restore_frames();
  std::string written_particles() const;

  RunPoint point_;
  Scene scene_;
  RunFolder& folder_;
  FrameTimes times_;
  Stopwatch watch_;
  Simulation simulation_;
  RunWriter writer_;
  RunSummary summary_;
};

}  // namespace kappaflow
