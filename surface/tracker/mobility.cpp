#include "surface/tracker/mobility.h"

#include <algorithm>
#include <array>

#include "core/shared_loop.h"

namespace kappaflow {
namespace {

// [1] What an outlier is off by: the scatter around it, and so much of the speed that rounding is none.
constexpr double kMedians = 3, kSpeeds = 0.1;
constexpr int kLargestRing = 64;  // of a mesh in good order about 6; the rest of a larger ring has no vote

}  // namespace

bool is_outlier(const VertexRings& rings, const SurfaceVelocities& velocities, int v) {
  const auto ring = rings.of(v).first(std::min<std::size_t>(rings.of(v).size(), kLargestRing));
  Vec3 mean = Vec3::Zero();
  double weight = 0, speed = 0;
  for (const int w : ring) {
    const double c = velocities.confidence[w];
    mean += c * c * velocities.velocity[w];
    weight += c * c;
    speed += velocities.velocity[w].norm() / static_cast<double>(ring.size());
  }
  if (!(weight > 0)) return false;  // nobody around knows better
  mean /= weight;
  std::array<double, kLargestRing> difference;
  for (std::size_t k = 0; k < ring.size(); ++k) difference[k] = (velocities.velocity[ring[k]] - mean).norm();
  const auto median = difference.begin() + static_cast<std::ptrdiff_t>(ring.size() / 2);
  std::nth_element(difference.begin(), median, difference.begin() + static_cast<std::ptrdiff_t>(ring.size()));
  return (velocities.velocity[v] - mean).norm() > std::max(kMedians * *median, kSpeeds * speed);
}

void vertex_mobility(const VertexRings& rings, const SurfaceVelocities& velocities,
                     std::span<double> mobility) {
  shared_for(
      mobility.size(),
      [&](std::size_t v) {
        const double c = velocities.confidence[v];
        mobility[v] = is_outlier(rings, velocities, static_cast<int>(v)) ? 1 : 1 - c * c;
      },
      kDefaultGrain, mobility);
}

}  // namespace kappaflow
