// `kappaflow check`: what a scene says and what it will cost, without running it.
#pragma once

#include <string>

#include "scenes/scene.h"

namespace kappaflow {

/// A readable summary of the scene with the estimate for this many threads.
std::string check_text(const Scene& scene, int threads);

}  // namespace kappaflow
