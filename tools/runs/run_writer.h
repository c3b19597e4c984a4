// What one frame of a simulated scene leaves in the run folder.
#pragma once

#include <span>
#include <vector>

#include "scenes/wall_distance.h"
#include "tools/runs/frame_writer.h"
#include "tools/runs/simulation.h"

namespace kappaflow {

/// Measures the liquid and its walls at each frame, and has the surfaces written beside them.
class RunWriter {
 public:
  /// Before the simulation's first step; writes walls that do not move. The arguments must outlive it.
  RunWriter(const Scene& scene, const Simulation& simulation, const std::vector<MeshFormat>& formats,
            RunFolder& folder);

  void write(int frame, double time, const SinceFrame& since_frame, RunSummary& summary);

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(writer_);
  }

 private:
  FrameMetrics liquid_metrics(int frame, double time, std::span<const float> density,
                              const SinceFrame& since_frame) const;
  void move_walls(int frame, double time);

  const Scene& scene_;
  const Simulation& simulation_;
  RunFolder& folder_;
  bool walls_move_;
  WallDistance walls_;  // where they are in the frame
  FrameWriter writer_;
};

}  // namespace kappaflow
