// Where each particle was when it was first seen.
#pragma once

#include <cstdint>
#include <vector>

#include "core/particles.h"

namespace kappaflow {

/// The first places of particles, by their ids: at the start, or where they are when a step of the surface
/// first finds them, sigma after the emitter at most.
class ParticleOrigins {
 public:
  /// Notes the places of those particles that have not been seen before.
  void see(const Particles& particles);

  /// The first places [m] of particles that have been seen, in their order.
  std::vector<Vec3> of(const Particles& particles) const;

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(id_, origin_);
  }

 private:
  std::vector<std::int64_t> id_;  // ascending
  std::vector<Vec3> origin_;      // of each
};

}  // namespace kappaflow
