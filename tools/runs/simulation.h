// A scene in motion: the liquid and, on it, one tracked surface for each velocity method.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/errors.h"
#include "core/work_group.h"
#include "scenes/prepared_scene.h"
#include "solver/ranks.h"
#include "surface/measure/material_tracers.h"
#include "surface/tracker/tracked_surfaces.h"
#include "tools/runs/liquid.h"

namespace kappaflow {

/// What ranks that follow surfaces do together, or this one alone where there are none. An Error all of them
/// come to; after anything else they are out of step, and stay busy.
template <class Work>
auto together(Ranks* ranks, const Work& work) {
  if (ranks == nullptr) return work();
  ranks->start();
  const SharedWork shared(ranks);
  try {
    auto result = work();
    ranks->finish();
    return result;
  } catch (const Error&) {
    ranks->finish();
    throw;
  }
}

/// What happened to liquid and surfaces since the last frame.
struct SimulationReport {
  double density_error_mean = 0, density_error_max = 0;  ///< the largest of FluidStep's
  double viscosity_error = 0;                            ///< likewise
  double solver_seconds = 0;                             ///< wall time of the liquid
  double tracer_seconds = 0;                             ///< and of the material tracers
  std::vector<TrackerStep> surfaces;                     ///< one entry a method

  /// See core/saved_state.h; without the wall times, and the surfaces, which save their own.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(density_error_mean, density_error_max, viscosity_error);
  }
};

/// Steps the liquid, and its surfaces in steps of their own: of as many of the liquid's as keep to
/// SurfaceOptions::motion_per_step.
class Simulation {
 public:
  /// Meshes the surface at t = 0. liquid: of this scene, at its start. Throws InvalidInput when the surface
  /// is empty.
  Simulation(const PreparedScene& prepared, std::unique_ptr<Liquid> liquid);
  /// With a solver of its own.
  explicit Simulation(PreparedScene prepared);

  /// Called after every step of the liquid, or, where that is of other processes, of the surfaces; returns
  /// whether to go on. There it takes one more step.
  using Watch = std::function<bool(const FluidStep&)>;

  /// Advances liquid and surfaces to `time` [s], where every vertex has a source. Returns false when `watch`
  /// stopped it on the way; the surfaces may then lag behind, and another call with the same time goes on as
  /// if it had not been.
  bool advance(double time, const Watch& watch);

  const Liquid& liquid() const { return *liquid_; }
  Liquid& liquid() { return *liquid_; }
  const Particles& particles() const { return surfaces_.particles(); }  ///< at the surfaces' time
  const TrackedSurfaces& surfaces() const { return surfaces_; }
  TrackedSurfaces& surfaces() { return surfaces_; }
  const MaterialTracers& tracers() const { return tracers_; }
  const Field& field() const { return surfaces_.field(); }
  /// Of walls and bodies.
  bool solids_move() const { return !bodies_.empty() || any_moves(walls_); }
  std::vector<SolidWall> solids_at_start() const;  ///< the walls, then the bodies
  std::vector<SolidWall> solids_now() const;       ///< and at rest there

  /// What happened since the last call; the next one starts anew.
  SimulationReport take_report();

  /// See core/saved_state.h; for a simulation of the same scene.
  template <class Archive>
  void serialize(Archive& archive) {
    if constexpr (Archive::is_loading::value)
      liquid_->read_state(archive);
    else
      liquid_->write_state(archive);
    serialize_surfaces(archive);
  }
  /// The same without the liquid.
  template <class Archive>
  void serialize_surfaces(Archive& archive) {
    archive(surfaces_, tracers_, liquid_->pace(), report_);
  }

 private:
  void note(const LiquidStep& step);
  void step_surfaces(Particles now);

  std::vector<SolidWall> walls_;
  std::vector<SolidWall> bodies_;  // at t = 0
  std::unique_ptr<Liquid> liquid_;
  TrackedSurfaces surfaces_;
  MaterialTracers tracers_;
  bool flows_in_;            // liquid from emitters
  bool is_to_stop_ = false;  // as the watch last said
  SimulationReport report_;  // but for the surfaces
};

}  // namespace kappaflow
