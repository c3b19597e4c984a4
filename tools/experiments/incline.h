// Validation: liquid from a hole in an incline.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Silicone oil against the outlines that Lister (1992) measured, and the theory of thin films.
Report validate_incline(const ExperimentContext& context);

}  // namespace kappaflow
