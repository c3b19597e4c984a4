// Every velocity method at one instant, against known motions and against the material velocity of a real
// flow.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_motions(const ExperimentContext& context);

}  // namespace kappaflow
