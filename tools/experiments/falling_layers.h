// Where the layers are in which an emitter made its liquid: the axis of a thread, the middle of a strip.
#pragma once

#include "core/types.h"
#include "solver/fluid_solver.h"

namespace kappaflow {

class FallingLayers {
 public:
  /// Of a liquid that one emitter makes in layers of `size` particles.
  FallingLayers(const FluidSolver& liquid, std::size_t size) : particles_(liquid.particles()), size_(size) {}

  std::size_t count() const { return particles_.size() / size_; }
  Vec3 center(std::size_t layer) const { return mean(particles_.position, layer); }
  double speed(std::size_t layer) const { return mean(particles_.velocity, layer).norm(); }

  /// The layers from `layer` down to the first one made: the first of them that is lower than y [m], or
  /// slower than `speed` [m/s]; layer 0 if none is. Precondition: layer < count().
  std::size_t first_below(double y, std::size_t layer) const;
  std::size_t first_slower(double speed, std::size_t layer) const;

  /// Where the line through the centers first comes down to y [m].
  Vec3 crossing(double y) const;

 private:
  Vec3 mean(const std::vector<Vec3>& values, std::size_t layer) const;

  Particles particles_;
  std::size_t size_;
};

}  // namespace kappaflow
