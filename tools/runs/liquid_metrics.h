// How well a simulated liquid does at one instant, as numbers.
#pragma once

#include <cstdint>
#include <span>

#include "scenes/wall_distance.h"
#include "solver/options.h"

namespace kappaflow {

/// Depth of the deepest particle centre inside a solid over `spacing` [m]; 0 when all are outside.
double penetration_max(std::span<const Vec3> position, const WallDistance& walls, double spacing);

/// Mean and largest compression max(rho / rho0 - 1, 0) of the particles [1]; rho in [kg/m3], rho0 the rest
/// density of the particle's fluid.
struct Compression {
  double mean = 0, max = 0;
};
Compression compression(std::span<const float> density, std::span<const std::uint8_t> fluid,
                        const FluidOptions& options);

}  // namespace kappaflow
