// Numbers of particles on a surface.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// At each point x the mean of the particles' values (Shepard, "A two-dimensional interpolation function for
/// irregularly-spaced data", 1968), with the weights (1 - r^2/sigma^2)^3 of those at distances r below sigma
/// [m]. `fallback` where there is none in reach.
std::vector<double> particle_means(std::span<const Vec3> points, std::span<const Vec3> position,
                                   std::span<const float> value, double sigma, double fallback);

}  // namespace kappaflow
