// Validation: the collapse of a column of water.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// The front on the floor against the measurements of Martin & Moyce (1952).
Report validate_dam_break(const ExperimentContext& context);

}  // namespace kappaflow
