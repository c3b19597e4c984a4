// Temperatures of surfaces and frames, where those of the particles are known.
#pragma once

#include "surface/tracker/tracked_surfaces.h"
#include "tools/io/particle_frame.h"
#include "tools/runs/metrics.h"

namespace kappaflow {

/// Gives the surfaces an array `temperature` [K].
void add_temperatures(TrackedSurfaces& surfaces);

/// Fills it with means of the particles near the vertices, see particle_means(), and the metrics with those
/// of all. Does nothing for particles without temperatures. Precondition: add_temperatures() before.
void set_temperatures(const ParticleFrame& frame, TrackedSurfaces& surfaces, FrameMetrics& metrics);

}  // namespace kappaflow
