// Emitters: mouths from which liquid flows into the scene, layer by layer.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "core/types.h"

namespace kappaflow {

struct FluidParticles;

struct DiscMouth {
  double radius = 0;  ///< [m]
};
struct RectangleMouth {
  double width = 0, height = 0;  ///< [m]
  Vec3 up{0, 1, 0};              ///< its part across the emitter's direction is that of `height`
};

/// A mouth that liquid leaves at a constant speed. Particles come in layers of a square lattice, one layer
/// every spacing / speed seconds, so that the stream has rest density from the mouth on. The last
/// kNozzleLength before the mouth they are led: they keep the emitter's velocity whatever pushes them, so
/// that the liquid in front of the mouth has liquid behind it.
struct Emitter {
  std::variant<DiscMouth, RectangleMouth> mouth;
  Vec3 position{0, 0, 0};                                ///< centre of the mouth [m]
  Vec3 direction{0, -1, 0};                              ///< of the flow; any length above 0
  double speed = 0;                                      ///< > 0 [m/s]
  double start = 0;                                      ///< when the first layer is at the mouth [s]
  double end = std::numeric_limits<double>::infinity();  ///< when the last one has left it [s]
  std::size_t max_particles = std::numeric_limits<std::size_t>::max();  ///< whole layers within this limit
  std::uint8_t fluid = 0;                                               ///< which fluid, see FluidOptions
  int source = 0;                                                       ///< of its particles
};

/// Length of the led stretch before the mouth, in spacings: the kernel's support.
inline constexpr double kNozzleLength = 2;

/// The particles of one layer in the plane of the mouth [m]: a square lattice of the spacing, symmetric about
/// the mouth's centre; in a disc the points no further out than its radius, in a rectangle whole cells.
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
  /// Precondition: check_emitter() passes for each.
  Emitters(std::span<const Emitter> emitters, double spacing);

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
  };

  void release(FluidParticles& particles) const;
  bool emit_layer(FluidParticles& particles, std::size_t nozzle, double distance) const;

  double spacing_;
  std::vector<Nozzle> nozzles_;
};

}  // namespace kappaflow
