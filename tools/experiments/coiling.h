// Validation: a thread that coils.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// The frequency of a coiling thread against the theory of slender threads (Ribe 2004).
Report validate_coiling(const ExperimentContext& context);

}  // namespace kappaflow
