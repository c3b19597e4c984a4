// Validations: what liquid must keep, or not exceed, whatever happens to it.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Linear and angular momentum of a spinning drop.
Report validate_drop(const ExperimentContext& context);

/// Speeds of a liquid at rest over a step.
Report validate_basin(const ExperimentContext& context);

/// Speeds of thin liquid that falls off stairs, against free fall.
Report validate_falling(const ExperimentContext& context);

}  // namespace kappaflow
