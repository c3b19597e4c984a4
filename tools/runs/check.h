// `kappaflow check`: what a scene says and what it will cost, without running it.
#pragma once

#include <cstddef>
#include <string>

#include "scenes/estimate.h"
#include "scenes/prepared_scene.h"

namespace kappaflow {

/// A readable summary of the scene with the estimate for this many threads.
std::string check_text(const PreparedScene& prepared, int threads);

/// Whether so many bytes are there for the scene's run, where the estimate knows.
bool has_room(const Scene& scene, std::size_t needed, std::size_t available);
/// Throws InvalidInput where the scene is foreseen to need more than `available` bytes of memory.
void require_memory(const Scene& scene, std::size_t needed, std::size_t available);

}  // namespace kappaflow
