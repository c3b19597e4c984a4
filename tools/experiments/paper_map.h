// A map of where the paper's statements on its turning particles hold: Figs. 4, 5 and 8 of Fujisawa, Mandachi
// & Miura (2011), over what it leaves open.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_paper_map(const ExperimentContext& context);

}  // namespace kappaflow
