// Particles at one instant, as the solver hands them to the surface and to files.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Particles at one instant, structure of arrays, sorted by ascending id. All arrays have one entry a
/// particle.
struct Particles {
  double time = 0;               ///< [s]
  std::vector<std::int64_t> id;  ///< unique, ascending; pairs a particle with itself at another instant
  std::vector<Vec3> position;    ///< [m]
  std::vector<Vec3> velocity;    ///< [m/s]

  std::size_t size() const { return id.size(); }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, id, position, velocity);
  }
};

/// Throws InvalidInput when array lengths differ, ids are not strictly ascending, or a number is not finite.
void check_particles(const Particles& particles);

}  // namespace kappaflow
