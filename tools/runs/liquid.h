// The liquid of a scene, as its surfaces and files see it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/saved_state.h"
#include "scenes/prepared_scene.h"
#include "solver/fluid_solver.h"
#include "tools/io/particle_frame.h"
#include "tools/runs/liquid_metrics.h"
#include "tools/runs/surface_temperature.h"

namespace kappaflow {

/// When the surfaces are to follow the liquid: before fast particles have moved further than a step of the
/// surfaces may take, SurfaceOptions::motion_per_step.
class SurfacePace {
 public:
  explicit SurfacePace(const Scene& scene)
      : most_(scene.surface.motion_per_step * (scene.surface.sigma * scene.fluid.spacing)) {}

  /// Whether they may wait for one more step of the liquid like the last one. speed: of fast particles [m/s];
  /// time_step [s].
  bool may_wait(double speed, double time_step);
  void follow() { way_ = 0; }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(way_);
  }

 private:
  double most_;     // [m]
  double way_ = 0;  // of fast particles since the surfaces' last step [m]
};

/// One step of the liquid, or several.
struct LiquidStep {
  FluidStep last;                ///< of the solver; its errors are the largest of all
  double seconds = 0;            ///< wall time
  bool surfaces_follow = false;  ///< whether the surfaces are to come where it ends
  Particles now;                 ///< there, if they are, but in frames: Liquid::particles()
};

/// All that there is to know of the liquid in a frame.
struct LiquidRecord {
  ParticleFrame particles;  ///< sorted by id; those that Liquid::particles() tells
  std::size_t count = 0;    ///< of all particles, as is what follows
  int pieces = 0;           ///< in so many files they are, where not all are told
  Compression compression;
  std::optional<TemperatureRange> temperature;  ///< where there is heat
  std::vector<std::size_t> taken;               ///< by each outflow region since t = 0
  std::vector<BodyState> bodies;
};

/// A liquid that is stepped from frame to frame: by this process, OwnLiquid, or by others, DistantLiquid.
class Liquid {
 public:
  explicit Liquid(const Scene& scene) : pace_(scene) {}
  virtual ~Liquid() = default;

  virtual int ranks() const = 0;    ///< that share it
  virtual double time() const = 0;  ///< [s]
  virtual std::size_t steps() const = 0;
  virtual std::size_t count() const = 0;  ///< of all particles; at t = 0 and in frames
  /// Whether particles() tells all of them, else those near the surface: near_surface_of().
  virtual bool tells_all() const { return true; }
  virtual Particles particles() const = 0;
  virtual std::vector<int> sources() const = 0;  ///< of these
  virtual std::vector<BodyState> bodies() const = 0;
  /// At t = 0 and in frames.
  virtual LiquidRecord record() const = 0;
  /// Whether a record can be had, after an error.
  virtual bool can_be_asked() const = 0;
  /// Where not all particles are told: sees to it that those of the frame that is reached are in the run's
  /// folder, in as many particle_piece()s as ranks.
  virtual void write_particles(const std::filesystem::path& /*folder*/, int /*frame*/) {}

  /// One step towards `until` [s], or several, which is the next frame. last: whether it is to be the last
  /// one, after which can_be_saved().
  virtual LiquidStep step(double until, bool last) = 0;
  virtual bool can_be_saved() const = 0;

  /// Those that follow the surfaces on it, where that are several, else nullptr: the same functions in all of
  /// them, but for those that only the first one is asked for: record(), write_particles(), and the state.
  virtual Ranks* surface_ranks() const { return nullptr; }

  /// See core/saved_state.h; for a liquid of the same scene.
  virtual void write_state(StateWriter& archive) = 0;
  virtual void read_state(StateReader& archive) = 0;
  SurfacePace& pace() { return pace_; }

 private:
  SurfacePace pace_;
};

/// A solver of this process, or the first one of the ranks that share the liquid.
class OwnLiquid : public Liquid {
 public:
  OwnLiquid(const Scene& scene, FluidSolver fluid, int ranks)
      : Liquid(scene), options_(scene.fluid), fluid_(std::move(fluid)), ranks_(ranks) {}

  int ranks() const override { return ranks_; }
  double time() const override { return fluid_.time(); }
  std::size_t steps() const override { return fluid_.steps(); }
  std::size_t count() const override { return fluid_.size(); }
  Particles particles() const override { return fluid_.particles(); }
  std::vector<int> sources() const override { return fluid_.sources(); }
  std::vector<BodyState> bodies() const override { return fluid_.bodies(); }
  LiquidRecord record() const override;
  bool can_be_asked() const override { return fluid_.can_be_asked(); }
  LiquidStep step(double until, bool last) override;
  bool can_be_saved() const override { return true; }
  void write_state(StateWriter& archive) override { archive(fluid_); }
  void read_state(StateReader& archive) override { archive(fluid_); }

 protected:
  const FluidSolver& fluid() const { return fluid_; }

 private:
  FluidOptions options_;
  FluidSolver fluid_;
  int ranks_;
};

/// All that a solver knows of its particles.
ParticleFrame particle_frame(const FluidSolver& fluid, Whose whose = Whose::all);

/// Whether times are the same but for rounding in the solver's sum of time steps [s].
inline bool is_reached(double time, double until) {
  constexpr double kTimeTolerance = 1e-12;
  return !(until - time > kTimeTolerance);
}

/// The number of a scene's last frame, which falls on its duration even where that is no multiple of the
/// frame time.
int last_frame_of(const Scene& scene);
/// Whether the frame is one of those after which the run is saved.
bool has_checkpoint(const Scene& scene, int frame);
/// Of a frame of the scene [s].
double frame_time(const Scene& scene, int frame);

/// The liquid of a scene; lets go of the scene's particles, of which it has a copy of its own. ranks: that
/// share it, this being one of them.
FluidSolver make_fluid(PreparedScene& prepared, Ranks* ranks);
std::unique_ptr<Liquid> own_liquid(PreparedScene& prepared, Ranks* ranks = nullptr);

}  // namespace kappaflow
