#include "core/particles.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace kappaflow {

void check_particles(const Particles& particles) {
  const std::size_t n = particles.size();
  if (particles.position.size() != n || particles.velocity.size() != n)
    throw InvalidInput(fmt::format("particles: {} ids, {} positions, {} velocities; the counts must be equal",
                                   n, particles.position.size(), particles.velocity.size()));
  if (!particles.scale.empty() && particles.scale.size() != n)
    throw InvalidInput(
        fmt::format("particles: {} ids, {} scales; the counts must be equal", n, particles.scale.size()));
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && particles.id[i] <= particles.id[i - 1])
      throw InvalidInput(fmt::format("particles: id {} follows id {}; ids must ascend", particles.id[i],
                                     particles.id[i - 1]));
    if (!particles.position[i].allFinite() || !particles.velocity[i].allFinite())
      throw InvalidInput(fmt::format("particle {}: position or velocity is not finite", particles.id[i]));
    if (!particles.scale.empty() && !(particles.scale[i] > 0))
      throw InvalidInput(fmt::format("particle {}: its scale is {}; it must be positive", particles.id[i],
                                     particles.scale[i]));
  }
}

}  // namespace kappaflow
