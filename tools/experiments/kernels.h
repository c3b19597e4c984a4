// Round kernels and kernels that follow the liquid: how smooth a surface is, where it lies, and how well the
// methods follow the liquid on it.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_kernels(const ExperimentContext& context);

}  // namespace kappaflow
