// Validations of rigid bodies: one that floats, one that sinks, and one that turns in a drop.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

/// A flat box that is pushed down: Archimedes' level, to which it returns.
Report validate_floating_box(const ExperimentContext& context);

/// A sphere on the axis of a cylinder: Stokes' speed with the correction of Haberman & Sayre, "Motion of
/// rigid and fluid spheres in stationary and moving liquids inside cylindrical tubes" (1958).
Report validate_sinking_sphere(const ExperimentContext& context);

/// A body in a drop without weight: linear and angular momentum of both together, and their energy.
Report validate_spinning_body(const ExperimentContext& context);

}  // namespace kappaflow
