// Validations: steady flow between two plates of liquids whose viscosity depends on the shear rate.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// Plane Poiseuille flow of a power law.
Report validate_power_law(const ExperimentContext& context);

/// Plane Poiseuille flow of a Bingham liquid, with its plug.
Report validate_bingham(const ExperimentContext& context);

/// Plane Couette flow of a Carreau liquid under a Newtonian one.
Report validate_carreau(const ExperimentContext& context);

}  // namespace kappaflow
