// Particles of a file in an order of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/io/input_frame.h"
#include "tools/io/particle_frame.h"

namespace kappaflow {

/// Indices of the particles in ascending order of their ids; those of one id as they lie.
std::vector<std::size_t> order_by_id(std::span<const std::int64_t> id);

/// The particles of these indices, at an instant [s]. Those that stand for others have the scale of their
/// zone.
ParticleFrame ordered_frame(const InputFrame& frame, std::span<const std::size_t> order, double time);

}  // namespace kappaflow
