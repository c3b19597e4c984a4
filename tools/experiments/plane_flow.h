// Validations: plane Poiseuille and Couette flow, in the middle of a slug of liquid between two plates.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// A body force along plates at rest.
Report validate_poiseuille(const ExperimentContext& context);

/// Plates that move against each other.
Report validate_couette(const ExperimentContext& context);

}  // namespace kappaflow
