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

std::optional<TemperatureRange> temperature_range(std::span<const float> temperature) {
  if (temperature.empty()) return std::nullopt;
  const std::size_t n = temperature.size();
  const double sum = parallel_sum(n, 0.0, [&](std::size_t i) { return static_cast<double>(temperature[i]); });
  const auto [least, most] = std::ranges::minmax(temperature);
  return TemperatureRange{static_cast<double>(least), sum / static_cast<double>(n),
                          static_cast<double>(most)};
}

void set_temperatures(const ParticleFrame& frame, const TemperatureRange& all, TrackedSurfaces& surfaces,
                      FrameMetrics& metrics) {
  metrics.temperature_min = all.min;
  metrics.temperature_mean = all.mean;
  metrics.temperature_max = all.max;
  for (std::size_t m = 0; m < surfaces.count(); ++m)
    std::ranges::copy(particle_means(surfaces.mesh(m).position, frame.particles.position, frame.temperature,
                                     surfaces.field_options().sigma, all.mean),
                      surfaces.array<double>(kTemperature, m).begin());
}

}  // namespace kappaflow
