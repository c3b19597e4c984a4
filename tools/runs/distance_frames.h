// The frames of another program's surfaces.
#pragma once

#include <optional>

#include "tools/runs/distance_sequence.h"
#include "tools/runs/frame_source.h"

namespace kappaflow {

class DistanceFrames final : public FrameSource {
 public:
  /// Reads the first frames; as FieldSurfaces. with_tracers: whether tracers follow the material where it is
  /// known. sequence: must outlive it.
  DistanceFrames(DistanceSequence& sequence, const SurfaceOptions& options, bool with_tracers);

  int last_frame() const override { return static_cast<int>(sequence_.size()) - 1; }
  double time_of(int frame) const override { return sequence_.time(static_cast<std::size_t>(frame)); }
  void prepare(int frame) override;
  bool advance(int frame, const Watch& watch) override;
  bool saves_between_frames() const override { return false; }
  double time() const override { return time_; }
  std::size_t steps() const override { return steps_; }
  const SurfaceGroup& surfaces() const override { return surfaces_; }
  SurfaceGroup& surfaces() override { return surfaces_; }
  const ParticleFieldOptions* particle_field() const override { return nullptr; }
  const MaterialTracers& tracers() const override { return tracers_; }
  FrameReport take_report(int frame) override;
  std::string kept_particles(const std::filesystem::path& file) const override;
  void write_state(StateWriter& archive) override { archive(*this); }
  void read_state(StateReader& archive) override { archive(*this); }

  template <class Archive>
  void serialize(Archive& archive) {
    archive(surfaces_, tracers_, time_, steps_);
  }

 private:
  DistanceSequence& sequence_;
  double motion_per_step_;                // [length scales]
  std::optional<DistanceMotion> motion_;  // to the frame that it is prepared for
  int prepared_for_ = 1;
  FieldSurfaces surfaces_;
  MaterialTracers tracers_;
  double time_;                // that the surfaces have reached [s]
  std::size_t steps_ = 0;      // since the first frame
  double tracer_seconds_ = 0;  // since the last one
};

}  // namespace kappaflow
