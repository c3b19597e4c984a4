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
  /// How large each is beside those that lengths like sigma are meant for [1], > 0; empty: all are 1.
  std::vector<double> scale{};

  std::size_t size() const { return id.size(); }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(time, id, position, velocity, scale);
  }
};

/// Throws InvalidInput when array lengths differ, ids are not strictly ascending, a number is not finite, or
/// a scale not positive.
void check_particles(const Particles& particles);

}  // namespace kappaflow
