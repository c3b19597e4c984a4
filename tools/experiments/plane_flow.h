// Validations: plane Poiseuille and Couette flow, in the middle of a slug of liquid between two plates.
#pragma once

#include <span>

#include "core/types.h"
#include "tools/experiments/experiment.h"
#include "tools/pictures/plot.h"

namespace kappaflow {

/// A body force along plates at rest.
Report validate_poiseuille(const ExperimentContext& context);

/// Plates that move against each other.
Report validate_couette(const ExperimentContext& context);

/// A curve of the profile (u, y / gap): points (y / gap, u) in their means over the layers of particles, as
/// far as there are points in them.
Curve layer_means(std::span<const Vec2> points, int layers);

}  // namespace kappaflow
