// What one frame of tracked surfaces leaves in the run folder, and the numbers that go with it.
#pragma once

#include <vector>

#include "scenes/scene.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/metrics.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/summary.h"
#include "tools/runs/tracked_surfaces.h"

namespace kappaflow {

/// Measures and writes frames; keeps what is the same in all of them.
class FrameWriter {
 public:
  /// Before the surfaces' first step. formats: of further mesh files beside each surface's .vtp.
  FrameWriter(const OutputDescription& output, const TrackedSurfaces& surfaces,
              std::vector<MeshFormat> formats, RunFolder& folder);

  /// Writes particles and surfaces, completes `metrics` (frame, time and what the caller knows of the
  /// particles) by the isosurface, and appends everything to tables and summary. watch: runs since the
  /// frame's output began.
  void write(FrameMetrics metrics, const ParticleFrame& particles, SurfacesSinceFrame since_frame,
             const Stopwatch& watch, RunSummary& summary);

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(last_frame_);
  }

 private:
  /// A mesh at an earlier time: ids below next_id, and how many vertices it had.
  struct Earlier {
    std::int64_t next_id = 0;
    std::size_t vertices = 0;

    template <class Archive>
    void serialize(Archive& archive) {
      archive(next_id, vertices);
    }
  };
  static double kept_share(const TriangleMesh& mesh, const Earlier& earlier);

  SurfaceMetrics write_surface(const FrameMetrics& frame, const TriangleMesh& isosurface, std::size_t m,
                               const SurfacesSinceFrame& since_frame);

  const OutputDescription& output_;
  const TrackedSurfaces& surfaces_;
  std::vector<MeshFormat> formats_;
  RunFolder& folder_;
  Earlier first_;
  Bounds initial_box_;               // of the first mesh
  std::vector<Earlier> last_frame_;  // the meshes at the last frame, one entry a method
};

}  // namespace kappaflow
