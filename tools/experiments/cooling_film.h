// Validation: a layer of lava that flows, cools and stiffens.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// The middle of a slug on a cold floor, under the air, against a column of a wide layer.
Report validate_cooling_film(const ExperimentContext& context);

}  // namespace kappaflow
