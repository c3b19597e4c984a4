#include "tools/experiments/falling_layers.h"

namespace kappaflow {

std::size_t FallingLayers::first_below(double y, std::size_t layer) const {
  while (layer > 0 && center(layer).y() > y) --layer;
  return layer;
}

std::size_t FallingLayers::first_slower(double speed, std::size_t layer) const {
  while (layer > 0 && this->speed(layer) > speed) --layer;
  return layer;
}

Vec3 FallingLayers::mean(const std::vector<Vec3>& values, std::size_t layer) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = layer * size_; i < (layer + 1) * size_; ++i) sum += values[i];
  return sum / static_cast<double>(size_);
}

}  // namespace kappaflow
