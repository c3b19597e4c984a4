// Enright's test: a sphere is drawn out into a thin sheet and, since the flow turns round, back.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_enright_particles(const ExperimentContext& context);  ///< Eq. 12 on particles in the flow
Report experiment_enright_exact(const ExperimentContext& context);      ///< the exact implicit function

}  // namespace kappaflow
