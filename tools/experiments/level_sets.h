// Level sets, which most of the related work tracks surfaces by, beside tracked meshes.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Throws IoError with the way to install it where there is no OpenVDB.
Report experiment_level_sets(const ExperimentContext& context);

}  // namespace kappaflow
