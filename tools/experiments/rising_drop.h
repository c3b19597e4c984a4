// Validation of liquids of different density: a drop that rises in another liquid.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// A light drop on the axis of a cylinder of heavy liquid: its speed with the walls' correction
/// (SphereInJar).
Report validate_rising_drop(const ExperimentContext& context);

}  // namespace kappaflow
