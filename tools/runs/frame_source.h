// Where the frames of a run come from: particles or another field in motion, with tracked surfaces on it.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/saved_state.h"
#include "core/solids.h"
#include "solver/rigid_body.h"
#include "surface/field/particle_motion.h"
#include "surface/measure/material_tracers.h"
#include "surface/measure/surface_metrics.h"
#include "surface/tracker/surface_group.h"
#include "tools/io/particle_frame.h"
#include "tools/runs/metrics.h"

namespace kappaflow {

/// What there is to write of a frame beside its surfaces, and what happened since the frame before.
struct FrameReport {
  ParticleFrame particles;  ///< empty where there are none
  /// Where only some of the particles are here: in so many pieces some of so many ranks have written all.
  int pieces = 0, ranks = 0;
  FrameMetrics metrics;  ///< without the isosurface
  /// Walls, then bodies, where they are in this frame; empty where none ever moves.
  std::vector<TriangleSurface> walls;
  std::vector<BodyState> bodies;
  std::vector<TrackerStep> steps;  ///< of each surface
  double liquid_seconds = 0;       ///< wall time
  double tracer_seconds = 0;       ///< likewise
};

/// What the field of a frame says.
struct FieldMeasures {
  std::size_t particles_outside = 0;
  std::optional<FreshIsosurface> isosurface;  ///< where the frame's surfaces are judged
};

/// What it says of a surface.
struct SurfaceMeasures {
  SurfaceState state;
  std::optional<SurfaceJudgement> judgement;
};

/// A simulation, or the files of another program. Frame 0 is there from the start.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  virtual int last_frame() const = 0;
  virtual double time_of(int frame) const = 0;  ///< [s]

  /// Gets ready to go to the frame after the one that is reached. Throws InvalidInput or IoError where it
  /// cannot be read.
  virtual void prepare(int /*frame*/) {}
  /// Called after every step with what else there is to say of it; returns whether to go on.
  using Watch = std::function<bool(const std::string& detail)>;
  /// Goes to the frame that it is prepared for. Returns false when `watch` stopped it on the way.
  virtual bool advance(int frame, const Watch& watch) = 0;
  /// Whether what was stopped on the way can be saved and gone on with.
  virtual bool saves_between_frames() const = 0;
  /// Whether what is reached can be saved: not in frames without a checkpoint where others must be asked for
  /// it, one step later.
  virtual bool can_be_saved() const { return true; }

  virtual double time() const = 0;        ///< that is reached [s]
  virtual std::size_t steps() const = 0;  ///< so far
  virtual const SurfaceGroup& surfaces() const = 0;
  virtual SurfaceGroup& surfaces() = 0;  ///< for whoever gives them arrays
  /// How particles become the surfaces' field; null where it is not of particles.
  virtual const ParticleFieldOptions* particle_field() const = 0;
  /// Whether FrameReport has all particles, else some of them, or there are none.
  virtual bool tells_particles() const { return particle_field() != nullptr; }

  virtual const MaterialTracers& tracers() const = 0;
  /// Walls, then bodies, at t = 0.
  virtual std::vector<TriangleSurface> walls_at_start() const { return {}; }
  virtual bool walls_move() const { return false; }  ///< at some time

  /// Of the frame that is reached; once a frame.
  virtual FrameReport take_report(int frame) = 0;
  /// particles: of its report.
  virtual FieldMeasures measure_field(bool is_judged, std::span<const Vec3> particles);
  virtual SurfaceMeasures measure_surface(std::size_t surface, const FieldMeasures& field);

  /// Where FrameReport has pieces: sees to it that those of the frame that is reached are in the run's
  /// folder.
  virtual void write_particles(const std::filesystem::path& /*folder*/, int /*frame*/) {}

  /// Sees to it that the particles of a failure are in a file, `file` where they are in none, and says so.
  virtual std::string kept_particles(const std::filesystem::path& file) const = 0;

  /// See core/saved_state.h; for a source that was made with the same arguments.
  virtual void write_state(StateWriter& archive) = 0;
  virtual void read_state(StateReader& archive) = 0;
};

}  // namespace kappaflow
