// The particles of one frame, wherever they come from.
#pragma once

#include <vector>

#include "core/particles.h"

namespace kappaflow {

/// Particles and what is known of them: one entry a particle in every array, or none where nothing is.
struct ParticleFrame {
  Particles particles;
  std::vector<float> density;        ///< [kg/m3]
  std::vector<float> pressure;       ///< [Pa]
  std::vector<int> source;           ///< which block or emitter it comes from
  std::vector<float> temperature{};  ///< [K]
};

}  // namespace kappaflow
