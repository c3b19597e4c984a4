// Validation: a viscous gravity current.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// The front of an axisymmetric current of constant volume against Huppert's similarity solution (1982).
Report validate_gravity_current(const ExperimentContext& context);

}  // namespace kappaflow
