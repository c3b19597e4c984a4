// A scene in motion: the liquid and, on it, one tracked surface for each velocity method.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "scenes/scene.h"
#include "surface/tracker/material_tracers.h"
#include "tools/timings.h"

namespace kappaflow {

/// What happened since the last frame.
struct SinceFrame {
  double density_error_mean = 0, density_error_max = 0;  ///< the largest of FluidStep's
  std::vector<double> residual_max;                      ///< the largest of TrackerStep's, one entry a method
  std::vector<TopologyCounts> topology;                  ///< the sum of TrackerStep's, one entry a method
  std::vector<PhaseSeconds> seconds;                     ///< one entry a method
  double tracer_seconds = 0;                             ///< wall time of the material tracers
};

/// Steps the liquid, and after every `stride` solver steps all trackers. They share one ParticleMotion and
/// one initial mesh, so that differences between methods are the methods' own.
class Simulation {
 public:
  /// Fills the blocks and meshes the surface at t = 0. Throws InvalidInput when the surface is empty.
  explicit Simulation(const Scene& scene);

  /// Called after every solver step; returns whether to go on.
  using Watch = std::function<bool(const FluidStep&)>;

  /// Advances liquid and surfaces to `time` [s]. Returns false when `watch` stopped it; the surfaces then lag
  /// behind.
  bool advance(double time, const Watch& watch);

  const FluidSolver& fluid() const { return fluid_; }
  const Particles& particles() const { return particles_; }  ///< at the trackers' time
  const Field& field() const { return *field_; }             ///< of the same
  const std::vector<SurfaceTracker>& trackers() const { return trackers_; }
  const MaterialTracers& tracers() const { return tracers_; }
  const std::vector<TriangleSurface>& walls() const { return walls_; }
  const ParticleFieldOptions& field_options() const { return field_options_; }
  std::size_t steps() const { return steps_; }

  /// Hands out what happened since the last call, and starts anew.
  SinceFrame take_since_frame();

 private:
  void step_surfaces();

  std::vector<TriangleSurface> walls_;
  FluidSolver fluid_;
  Particles particles_;
  ParticleFieldOptions field_options_;
  std::shared_ptr<const Field> field_;
  std::vector<SurfaceTracker> trackers_;
  MaterialTracers tracers_;
  int stride_;
  std::size_t steps_ = 0;
  SinceFrame since_frame_;
};

}  // namespace kappaflow
