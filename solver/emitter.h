// Emitters: mouths from which liquid flows into the scene, layer by layer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "solver/options.h"

namespace kappaflow {

struct FluidParticles;

/// Length of the led stretch before the mouth, in spacings: the kernel's support.
inline constexpr double kNozzleLength = 2;

/// The particles of one layer in the plane of the mouth [m]: a square lattice of the spacing, symmetric about
/// the mouth's centre; in a disc the points no further out than its radius, in a rectangle whole cells. Each
/// layer of thick liquid (viscous_pressure.h) in a disc is turned by the golden angle against the one before.
std::vector<Vec3> emitter_layer(const Emitter& emitter, double spacing);

/// Layers that have been made by `time` [s], those still in the nozzle included. layer_size: particles of a
/// layer, >= 1. Infinite at infinity for an emitter without an end.
double emitted_layers(const Emitter& emitter, double spacing, std::size_t layer_size, double time);

/// Throws InvalidInput, which names the value and what is allowed, for an emitter that is out of range or
/// emits nothing. fluids: how many there are.
void check_emitter(const Emitter& emitter, double spacing, std::size_t fluids);

/// The emitters of a solver, at most 255.
class Emitters {
 public:
  /// Those of the options. Precondition: check_emitter() passes for each.
  explicit Emitters(const FluidOptions& options);

  /// Lets go of the particles that have passed their mouth, and appends those of the layers that are due at
  /// `time` [s], except where liquid has come into the nozzle. Returns whether any was appended; then all
  /// arrays that follow from the positions are out of date.
  bool emit(FluidParticles& particles, double time);

  /// The largest speed of an emitter that has layers left [m/s]; 0: none has.
  double fastest() const;

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    for (Nozzle& nozzle : nozzles_) archive(nozzle.made, nozzle.done);
  }

 private:
  struct Nozzle {
    Emitter emitter;
    std::vector<Vec3> layer;
    double made = 0;  // layers
    bool done = false;
    bool turns = false;  // each layer against the one before
  };

  void release(FluidParticles& particles) const;
  bool emit_layer(FluidParticles& particles, std::size_t nozzle, double distance) const;

  double spacing_;
  std::vector<Nozzle> nozzles_;
};

}  // namespace kappaflow
