// `kappaflow check`: what a scene says and what it will cost, without running it.
#pragma once

#include <cstddef>
#include <string>

#include "scenes/estimate.h"
#include "scenes/prepared_scene.h"

namespace kappaflow {

/// A readable summary of the scene with the estimate for this many threads.
std::string check_text(const PreparedScene& prepared, int threads);

/// Throws InvalidInput where the scene's estimate is more than `available` bytes of memory. place: see
/// estimate().
void require_memory(const PreparedScene& prepared, std::size_t available, const LiquidPlace& place = {});

/// Of the machine [bytes].
std::size_t machine_memory();

}  // namespace kappaflow
