// Emitters: mouths from which liquid flows into the scene, layer by layer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/body_motion.h"
#include "core/types.h"
#include "solver/emitter_flow.h"
#include "solver/options.h"

namespace kappaflow {

struct FluidParticles;

/// Length of the led stretch before the mouth, in spacings: the kernel's support.
inline constexpr double kNozzleLength = 2;

/// The particles of one layer in the plane of the mouth [m]: a square lattice of the spacing, symmetric about
/// the mouth's centre; in a disc the points no further out than its radius, in a rectangle whole cells. Each
/// layer of thick liquid (viscous_pressure.h) in a disc is turned by the golden angle against the one before.
std::vector<Vec3> emitter_layer(const Emitter& emitter, double spacing);

/// Layers of the mean stream that have been made by `time` [s], those still in the nozzle included.
/// layer_size: particles of a layer, >= 1. May be infinite at infinity for an emitter without an end.
double emitted_layers(const Emitter& emitter, double spacing, std::size_t layer_size, double time);

/// Throws InvalidInput, which names the value and what is allowed, for an emitter that is out of range or
/// emits nothing. fluids: how many there are.
void check_emitter(const Emitter& emitter, double spacing, std::size_t fluids);

/// The emitters of a solver, at most 255.
class Emitters {
 public:
  /// Those of the options. Precondition: check_emitter() passes for each.
  explicit Emitters(const FluidOptions& options);

  /// Gives the led particles of emitters that move, or change their speed, the velocity that takes them to
  /// where the nozzle has them at time + time_step [s].
  void lead(FluidParticles& particles, double time, double time_step);

  /// Lets go of the particles that have passed their mouth, and appends those that are due at `time` [s],
  /// except where liquid has come into the nozzle. Returns whether any was appended; then all arrays that
  /// follow from the positions are out of date.
  bool emit(FluidParticles& particles, double time);

  /// The largest speed in [t0, t1] of an emitter that has layers left [m/s]; 0: none has.
  double fastest(double t0, double t1) const;

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    for (Nozzle& nozzle : nozzles_) archive(nozzle.made, nozzle.done);
  }

 private:
  struct Nozzle {
    Nozzle(const Emitter& of, const FluidOptions& options);

    bool is_steady() const { return emitter.ramp.empty() && emitter.motion.at_rest(); }
    double columns_made(double share, double layers) const;
    double layers_due(double time) const;

    Emitter emitter;
    Vec3 direction;
    std::vector<Vec3> layer;  // in the plane of the mouth, from its centre
    std::size_t layer_size;   // with those of a profile that stand still
    SpeedProfile profile;
    double spacing, reach;  // reach: of the layer from the centre
    double made = 0;        // layers of the mean stream; with a profile a share of the next one too
    bool done = false;
    bool turns = false;  // each layer against the one before
    RigidPose from, to;  // at the step's ends
    double way = 0;      // of the mean stream in the step [m]
  };

  void release(FluidParticles& particles, double time);
  void collect_due(const Nozzle& nozzle, double layers, double way);
  bool add_due(FluidParticles& particles, std::size_t nozzle, double time);

  std::vector<Nozzle> nozzles_;
  // Of one nozzle, while they are added; in its rest position.
  std::vector<Vec3> due_;
  std::vector<Vec3> near_;
};

}  // namespace kappaflow
