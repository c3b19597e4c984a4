// Validation: a strip that folds.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// The frequency of a folding strip against that of a slender one.
Report validate_folding(const ExperimentContext& context);

}  // namespace kappaflow
