// Particles of a viscous flow, as another simulator left them.
#pragma once

#include "tests/surface/reference_data.h"

namespace kappaflow::testing {

/// Frame 5, 12, 25 or 40 of scenes/experiments/data: 2,160 particles of a viscous flow, sigma = 0.127 m
/// (two spacings), w = 1, half-median threshold. Read by VTK.
Body read_staircase_frame(int frame);

}  // namespace kappaflow::testing
