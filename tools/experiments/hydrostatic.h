// Validation: liquid at rest in a basin.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Pressure against rho g (depth), and the level of the surface, at several resolutions.
Report validate_hydrostatic(const ExperimentContext& context);

}  // namespace kappaflow
