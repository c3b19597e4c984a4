#include "tools/runs/surface_temperature.h"

#include <algorithm>

#include "core/parallel.h"
#include "surface/measure/particle_means.h"

namespace kappaflow {
namespace {

constexpr const char* kTemperature = "temperature";

}  // namespace

void add_temperatures(TrackedSurfaces& surfaces) {
  surfaces.add_array(kTemperature, Carry::interpolate, 0.0);
}

void set_temperatures(const ParticleFrame& frame, TrackedSurfaces& surfaces, FrameMetrics& metrics) {
  const std::vector<float>& value = frame.temperature;
  if (value.empty()) return;
  const double mean =
      parallel_sum(value.size(), 0.0, [&](std::size_t i) { return static_cast<double>(value[i]); }) /
      static_cast<double>(value.size());
  const auto [least, most] = std::ranges::minmax(value);
  metrics.temperature_min = static_cast<double>(least);
  metrics.temperature_mean = mean;
  metrics.temperature_max = static_cast<double>(most);
  for (std::size_t m = 0; m < surfaces.count(); ++m)
    std::ranges::copy(particle_means(surfaces.mesh(m).position, frame.particles.position, value,
                                     surfaces.field_options().sigma, mean),
                      surfaces.array<double>(kTemperature, m).begin());
}

}  // namespace kappaflow
