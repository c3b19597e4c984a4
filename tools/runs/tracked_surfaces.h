// The surfaces of one body of particles, wherever the particles come from: one for each velocity method.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/particles.h"
#include "scenes/scene.h"
#include "surface/measure/material_tracers.h"
#include "tools/runs/timings.h"

namespace kappaflow {

/// What happened to the surfaces since the last frame.
struct SurfacesSinceFrame {
  std::vector<double> residual_max;      ///< the largest of TrackerStep's, one entry a method
  std::vector<TopologyCounts> topology;  ///< the sum of TrackerStep's, one entry a method
  std::vector<PhaseSeconds> seconds;     ///< one entry a method
  double tracer_seconds = 0;             ///< wall time of the material tracers

  /// See core/saved_state.h; without the wall times, which differ from run to run.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(residual_max, topology);
  }
};

/// The field that a description asks for. spacing: of the particles [m]; liquid: what a threshold that is not
/// given is taken from.
ParticleFieldOptions field_options(const SurfaceDescription& description, double spacing,
                                   std::span<const Vec3> liquid);

/// Steps all trackers through the same FieldMotion. They start from one mesh, so that differences between
/// methods are the methods' own.
class TrackedSurfaces {
 public:
  /// Meshes the surface of a field that was made with `options`. source: what its particles come from, for
  /// errors. Throws InvalidInput when the surface is empty.
  TrackedSurfaces(std::shared_ptr<const Field> field, const ParticleFieldOptions& options,
                  const SurfaceDescription& description, const std::string& source);

  void step(FieldMotion& motion);
  /// Makes the surfaces ready to be shown: SurfaceTracker::settle().
  void settle();

  const Field& field() const { return *field_; }  ///< at the end of the last step
  const std::vector<SurfaceTracker>& trackers() const { return trackers_; }
  const MaterialTracers& tracers() const { return tracers_; }
  const ParticleFieldOptions& field_options() const { return options_; }

  /// Gives every vertex of unknown source that of the nearest particle. One entry a particle; source may be
  /// empty, and then nothing happens.
  void find_sources(std::span<const Vec3> position, std::span<const int> source);

  /// Hands out what happened since the last call, and starts anew.
  SurfacesSinceFrame take_since_frame();

  /// See core/saved_state.h; for surfaces that were made with the same arguments. field() is not saved: there
  /// is none until the next step.
  template <class Archive>
  void serialize(Archive& archive) {
    for (SurfaceTracker& tracker : trackers_) archive(tracker);
    archive(tracers_, since_frame_);
    if constexpr (Archive::is_loading::value) field_ = nullptr;
  }

 private:
  void add_to_frame(std::size_t method, const TrackerStep& step);

  ParticleFieldOptions options_;
  std::shared_ptr<const Field> field_;
  std::vector<SurfaceTracker> trackers_;
  MaterialTracers tracers_;
  SurfacesSinceFrame since_frame_;
};

}  // namespace kappaflow
