// What the solver starts from: checks of the user's input, and the particles in the solver's own form.
#pragma once

#include <span>
#include <vector>

#include "core/solid_wall.h"
#include "solver/fluid_particles.h"
#include "solver/options.h"

namespace kappaflow {

/// Throws InvalidInput, which names the option, its value and what is allowed, for the first option out of
/// range.
void check_options(const FluidOptions& options);

/// Throws InvalidInput for arrays of different length, a number that is not finite, a particle inside one of
/// the walls, or a fluid that is not one of the `fluids`.
void check_start(std::span<const Vec3> position, std::span<const Vec3> velocity,
                 std::span<const std::uint8_t> fluid, std::size_t fluids, std::span<const int> source,
                 std::span<const SolidWall> walls);

/// Throws InvalidInput for another number of temperatures than of particles, where there are any, for one
/// that is not above 0 K, and for temperatures without heat.
void check_temperatures(std::span<const double> temperature, std::size_t particles,
                        const FluidOptions& options);

/// FluidParticles::mass_of_fluid.
std::vector<float> masses_of_fluids(const FluidOptions& options);

/// Particles in the given order, ids 0, 1, ...; pressures zero. fluid, source: empty where all are 0.
FluidParticles particles_at_start(std::span<const Vec3> position, std::span<const Vec3> velocity,
                                  std::span<const std::uint8_t> fluid = {}, std::span<const int> source = {});

}  // namespace kappaflow
