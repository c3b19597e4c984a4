// What one frame of tracked surfaces leaves in the run folder, and the numbers that go with it.
#pragma once

#include <string>
#include <vector>

#include "scenes/scene.h"
#include "surface/measure/material_tracers.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/metrics.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/summary.h"

namespace kappaflow {

/// What happened since the last frame.
struct SurfacesSinceFrame {
  std::vector<TrackerStep> steps;  ///< one entry a method
  double tracer_seconds = 0;       ///< wall time of the material tracers
  double solver_seconds = 0;       ///< wall time of the liquid
};

/// Measures and writes frames; keeps what is the same in all of them.
class FrameWriter {
 public:
  /// Before the surfaces' first step. methods: what files and tables call the surfaces; formats: of further
  /// mesh files beside each surface's .vtp.
  FrameWriter(const OutputDescription& output, std::vector<std::string> methods,
              const TrackedSurfaces& surfaces, const MaterialTracers& tracers,
              std::vector<MeshFormat> formats, RunFolder& folder);

  /// Writes particles and surfaces, completes `metrics` (frame, time and what the caller knows of the
  /// particles) by the isosurface, and appends everything to tables and summary. watch: runs since the
  /// frame's output began.
  void write(FrameMetrics metrics, const ParticleFrame& particles, const SurfacesSinceFrame& since_frame,
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
                               const TrackerStep& since_frame);

  const OutputDescription& output_;
  std::vector<std::string> methods_;
  const TrackedSurfaces& surfaces_;
  const MaterialTracers& tracers_;
  std::vector<MeshFormat> formats_;
  RunFolder& folder_;
  Earlier first_;
  Bounds initial_box_;               // of the first mesh
  std::vector<Earlier> last_frame_;  // the meshes at the last frame, one entry a method
};

}  // namespace kappaflow
