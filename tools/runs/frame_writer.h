// What one frame leaves in the run folder, and the numbers that go with it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "surface/measure/texture.h"
#include "surface/measure/traced_texture.h"
#include "surface/tracker/rest_pair.h"
#include "tools/runs/frame_export.h"
#include "tools/runs/frame_source.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/summary.h"

namespace kappaflow {

/// Measures and writes frames; keeps what is the same in all of them.
class FrameWriter {
 public:
  /// Before the source's first step; writes walls that never move. methods: what files and tables call the
  /// surfaces; formats: of the files for other programs. The references must outlive it.
  FrameWriter(FrameSource& source, const OutputDescription& output, std::vector<std::string> methods,
              const std::vector<MeshFormat>& formats, RunFolder& folder);

  /// Writes the frame that the source has reached: particles, walls that move and surfaces into their files,
  /// what was measured into tables and summary.
  void write(int frame, FrameSource& source, RunSummary& summary);

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(last_frame_, traced_);
    if (rest_pair_) archive(*rest_pair_);
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

  void write_walls(const FrameReport& report);
  void write_particles(const FrameReport& report, const ParticleFieldOptions& field);
  SurfaceMetrics write_surface(const FrameMetrics& frame, std::size_t m, const SurfaceState& state,
                               const TrackerStep& since_frame);
  bool is_judged(int frame) const;
  void measure_texture(int frame, std::size_t m, SurfaceMetrics& metrics);
  vtkSmartPointer<vtkPolyData> file_data(const FrameMetrics& frame, std::size_t m, const SurfaceState& state,
                                         std::span<const Vec2> texture) const;
  void write_mesh(const FrameMetrics& frame, std::size_t m, const SurfaceState& state);

  const OutputDescription& output_;
  std::vector<std::string> methods_;
  const SurfaceGroup& surfaces_;
  const MaterialTracers& tracers_;
  int last_;  // the last frame
  RunFolder& folder_;
  std::shared_ptr<const FrameExport> export_;  // shared with what is written beside the computation
  Earlier first_;
  Bounds initial_box_;  // of the first mesh
  Checker checker_;
  std::optional<RestPair> rest_pair_;
  std::vector<Earlier> last_frame_;    // the meshes at the last frame, one entry a method
  std::vector<TracedTexture> traced_;  // likewise, where that frame or the next one is judged
};

}  // namespace kappaflow
