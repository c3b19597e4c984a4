// Particles so far from all others that no surface can be near them.
#pragma once

#include <optional>

#include "surface/field/particle_field.h"

namespace kappaflow {

/// The particles without those that have no part in f = 0: within the support of particle i, f <= sum_j w_j -
/// T over the particles within sigma_i + sigma_j of it, itself included; where that is negative, so is f,
/// with it and without. nullopt where the particles' box has few cells for their number: a cell grid copes
/// with that. Requires positive sigmas.
std::optional<FieldParticles> without_strays(const FieldParticles& particles, double threshold);

}  // namespace kappaflow
