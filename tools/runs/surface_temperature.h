// Temperatures of surfaces and frames, where those of the particles are known.
#pragma once

#include <optional>
#include <span>

#include "surface/tracker/tracked_surfaces.h"
#include "tools/io/particle_frame.h"
#include "tools/runs/metrics.h"

namespace kappaflow {

/// Gives the surfaces an array `temperature` [K].
void add_temperatures(TrackedSurfaces& surfaces);

/// Of particles [K].
struct TemperatureRange {
  double min = 0, mean = 0, max = 0;
};
/// Of none nothing.
std::optional<TemperatureRange> temperature_range(std::span<const float> temperature);

/// Fills it with means of the particles near the vertices, see particle_means(), and the metrics with those
/// of all. Precondition: add_temperatures() before.
void set_temperatures(const ParticleFrame& frame, const TemperatureRange& all, TrackedSurfaces& surfaces,
                      FrameMetrics& metrics);

}  // namespace kappaflow
