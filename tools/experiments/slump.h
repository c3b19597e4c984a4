// Validation: a cylinder of a Bingham liquid slumps and comes to rest.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Its final height against the slump of Murata (1984) in the form of Pashias, Boger, Summers & Glenister
/// (1996).
Report validate_slump(const ExperimentContext& context);

}  // namespace kappaflow
