// Random particle sets for the tests of the field.
#pragma once

#include <random>

#include "surface/field/particle_field.h"

namespace kappaflow::testing {

inline Vec3 random_vector(std::mt19937& random, double half_width) {
  std::uniform_real_distribution<double> along(-half_width, half_width);
  const double x = along(random), y = along(random), z = along(random);
  return {x, y, z};
}

/// Particles in a cube of the given half width with sigma in [0.8, 1.2], weights in [0.5, 1.5] and moving
/// weights.
inline FieldParticles random_particles(unsigned seed, int count, double half_width) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> around_one(-1, 1);
  FieldParticles p;
  for (int i = 0; i < count; ++i) {
    p.position.push_back(random_vector(random, half_width));
    p.velocity.push_back(random_vector(random, 2));
    p.sigma.push_back(1 + 0.2 * around_one(random));
    p.weight.push_back(1 + 0.5 * around_one(random));
    p.weight_rate.push_back(around_one(random));
  }
  return p;
}

}  // namespace kappaflow::testing
