// How often a closed mesh goes around each point of a lattice.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/field/field.h"

namespace kappaflow {

/// The winding number of a closed oriented mesh at every point of the lattice (whose values are not read),
/// indexed as SampledField::value: 1 inside, 0 outside, others where the mesh passes through itself.
/// Crossings are counted along rows in x that lie 0.0014 and 0.0029 spacings beside the points in y and z, so
/// that they miss vertices which lie on the lattice's edges. Winding numbers beyond +-127 are not told apart.
std::vector<std::int8_t> winding_numbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                         const SampledField& lattice);

}  // namespace kappaflow
