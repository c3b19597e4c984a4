// The frames of a simulated scene.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "scenes/prepared_scene.h"
#include "scenes/wall_distance.h"
#include "solver/ranks.h"
#include "tools/runs/frame_source.h"
#include "tools/runs/simulation.h"

namespace kappaflow {

class SceneFrames : public FrameSource {
 public:
  /// As Simulation.
  SceneFrames(const PreparedScene& prepared, std::unique_ptr<Liquid> liquid);

  std::size_t particles() const { return simulation_.liquid().count(); }  ///< of all the liquid
  int liquid_ranks() const { return simulation_.liquid().ranks(); }       ///< that share the liquid
  int last_frame() const override { return last_frame_of(scene_); }
  double time_of(int frame) const override { return frame_time(scene_, frame); }
  bool advance(int frame, const Watch& watch) override;
  bool saves_between_frames() const override { return true; }
  bool can_be_saved() const override { return simulation_.liquid().can_be_saved(); }
  double time() const override { return simulation_.liquid().time(); }
  std::size_t steps() const override { return simulation_.liquid().steps(); }
  const TrackedSurfaces& surfaces() const override { return simulation_.surfaces(); }
  TrackedSurfaces& surfaces() override { return simulation_.surfaces(); }
  const ParticleFieldOptions* particle_field() const override { return &surfaces().field_options(); }
  bool tells_particles() const override { return simulation_.liquid().tells_all(); }
  const MaterialTracers& tracers() const override { return simulation_.tracers(); }
  std::vector<TriangleSurface> walls_at_start() const override;
  bool walls_move() const override { return simulation_.solids_move(); }
  FrameReport take_report(int frame) override;
  FieldMeasures measure_field(bool is_judged, std::span<const Vec3> particles) override;
  SurfaceMeasures measure_surface(std::size_t surface, const FieldMeasures& field) override;
  void write_particles(const std::filesystem::path& folder, int frame) override {
    simulation_.liquid().write_particles(folder, frame);
  }
  std::string kept_particles(const std::filesystem::path& file) const override;
  void write_state(StateWriter& archive) override { archive(simulation_); }
  void read_state(StateReader& archive) override;

  /// On the other ranks that follow the surfaces: does what the first one does, until that is through.
  void follow();

 private:
  Ranks* surface_ranks() const { return simulation_.liquid().surface_ranks(); }
  void announce(RankTask task, double value);
  bool go_to(int frame, const Watch& watch);
  void restore_followed();

  Scene scene_;
  Simulation simulation_;
  WallDistance wall_distance_;  // where walls and bodies are in the frame
};

}  // namespace kappaflow
