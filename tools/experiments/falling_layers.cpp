#include "tools/experiments/falling_layers.h"

#include <algorithm>

namespace kappaflow {

std::size_t FallingLayers::first_below(double y, std::size_t layer) const {
  while (layer > 0 && center(layer).y() > y) --layer;
  return layer;
}

std::size_t FallingLayers::first_slower(double speed, std::size_t layer) const {
  while (layer > 0 && this->speed(layer) > speed) --layer;
  return layer;
}

Vec3 FallingLayers::crossing(double y) const {
  const std::size_t last = count() - 1, k = first_below(y, last);
  const Vec3 below = center(k), above = center(std::min(k + 1, last));
  const double drop = above.y() - below.y();
  return drop > 0 ? Vec3(below + (y - below.y()) / drop * (above - below)) : below;
}

Vec3 FallingLayers::mean(const std::vector<Vec3>& values, std::size_t layer) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = layer * size_; i < (layer + 1) * size_; ++i) sum += values[i];
  return sum / static_cast<double>(size_);
}

}  // namespace kappaflow
