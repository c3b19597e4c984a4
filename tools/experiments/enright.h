// Enright's test: a sphere is drawn out into a thin sheet and, since the flow turns round, back.
#pragma once

#include <vector>

#include "tools/experiments/enright_results.h"
#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_enright_particles(const ExperimentContext& context);  ///< Eq. 12 on particles in the flow
Report experiment_enright_exact(const ExperimentContext& context);      ///< the exact implicit function

/// Of one of these the meshes of the edge length that are remeshed. context.file: of its options.
std::vector<EnrightResult> remeshed_in_enright(const ExperimentContext& context, bool on_particles);

}  // namespace kappaflow
