// The frames of another program's particles.
#pragma once

#include "surface/tracker/tracked_surfaces.h"
#include "tools/io/particle_sequence.h"
#include "tools/runs/frame_source.h"

namespace kappaflow {

class SequenceFrames final : public FrameSource {
 public:
  /// Reads the first two frames; as TrackedSurfaces. with_tracers: whether tracers follow the material.
  /// sequence: must outlive it.
  SequenceFrames(ParticleSequence& sequence, const SurfaceOptions& options, bool with_tracers);

  int last_frame() const override { return static_cast<int>(sequence_.size()) - 1; }
  double time_of(int frame) const override { return sequence_.time(frame); }
  void prepare(int frame) override;
  bool advance(int frame, const Watch& watch) override;
  bool saves_between_frames() const override { return false; }
  double time() const override { return time_; }
  std::size_t steps() const override { return steps_; }
  const TrackedSurfaces& surfaces() const override { return surfaces_; }
  TrackedSurfaces& surfaces() override { return surfaces_; }
  const ParticleFieldOptions* particle_field() const override { return &surfaces_.field_options(); }
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
  ParticleSequence& sequence_;
  ParticleFrame now_;
  Particles next_;                // what now_'s go on to
  std::size_t prepared_for_ = 0;  // the frame that they are of
  int steps_to_next_ = 0;         // from now_
  double speed_to_next_ = 0;      // see TrackedSurfaces::steps_to()
  TrackedSurfaces surfaces_;
  MaterialTracers tracers_;
  double time_;                // that the surfaces have reached [s]
  bool has_temperatures_;      // of particles in the first frame
  std::size_t steps_ = 0;      // since the first frame
  double tracer_seconds_ = 0;  // since the last one
};

}  // namespace kappaflow
