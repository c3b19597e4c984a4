// The minimisers that Fujisawa, Mandachi & Miura (2011) name for Eq. 10 beside its closed form.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_minimisers(const ExperimentContext& context);

}  // namespace kappaflow
