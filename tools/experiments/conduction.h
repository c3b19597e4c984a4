// Validations of heat: conduction through a layer, and a sphere that cools in the air.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// A layer on a wall that is suddenly hot, insulated above, against the Fourier series (Carslaw & Jaeger,
/// "Conduction of heat in solids", 1959, section 3.4).
Report validate_conduction(const ExperimentContext& context);

/// A sphere that loses heat by convection, against the series of Carslaw & Jaeger 1959, section 9.4.
Report validate_cooling(const ExperimentContext& context);

}  // namespace kappaflow
