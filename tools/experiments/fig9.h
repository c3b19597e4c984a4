// Fig. 9 of Fujisawa, Mandachi & Miura (2011): a viscous liquid on a staircase, tracked with every method.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_fig9(const ExperimentContext& context);

}  // namespace kappaflow
