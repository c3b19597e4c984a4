#include "surface/tracker/rest_pair.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/measure/texture.h"

namespace kappaflow {
namespace {

constexpr const char* kWeight = "rest_2_weight";

}  // namespace

RestPair::RestPair(SurfaceGroup& surfaces, int interval) : interval_(interval) {
  // A vertex that comes from nowhere between two frames is given its place in the next one.
  const Vec3 unknown = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const char* name : kNames) surfaces.add_array(name, Carry::interpolate, unknown);
  surfaces.add_array(kWeight, Carry::recompute, 0.0);
  for (const int which : {0, 1}) reset(surfaces, which);
}

void RestPair::update(SurfaceGroup& surfaces, int frame) {
  if (frame % interval_ == 0) reset(surfaces, frame / interval_ % 2);
  const double phase = static_cast<double>(frame % (2 * interval_)) / interval_;
  for (std::size_t m = 0; m < surfaces.count(); ++m) {
    std::ranges::fill(surfaces.array<double>(kWeight, m), std::abs(1 - phase));
    for (const char* name : kNames) {
      const std::span<Vec3> rest = surfaces.array<Vec3>(name, m);
      for (std::size_t v = 0; v < rest.size(); ++v)
        if (!rest[v].allFinite()) rest[v] = surfaces.mesh(m).position[v];
    }
  }
}

void RestPair::reset(SurfaceGroup& surfaces, int which) {
  for (std::size_t m = 0; m < surfaces.count(); ++m)
    std::ranges::copy(surfaces.mesh(m).position, surfaces.array<Vec3>(kNames[which], m).begin());
  box_[which] = bounding_box(surfaces.mesh().position);
}

}  // namespace kappaflow
