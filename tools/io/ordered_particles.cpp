#include "tools/io/ordered_particles.h"

#include <algorithm>
#include <numeric>

#include "tools/io/near_surface.h"

namespace kappaflow {
namespace {

template <class T>
std::vector<T> ordered(const std::vector<T>& values, std::span<const std::size_t> order) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(order.size());
  for (const std::size_t i : order) result.push_back(values[i]);
  return result;
}

}  // namespace

std::vector<std::size_t> order_by_id(std::span<const std::int64_t> id) {
  std::vector<std::size_t> order(id.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (!std::ranges::is_sorted(id)) std::ranges::stable_sort(order, {}, [&](std::size_t i) { return id[i]; });
  return order;
}

ParticleFrame ordered_frame(const InputFrame& frame, std::span<const std::size_t> order, double time) {
  ParticleFrame result{
      {time, ordered(frame.id, order), ordered(frame.position, order), ordered(frame.velocity, order)},
      ordered(frame.density, order),
      ordered(frame.pressure, order),
      ordered(frame.source, order),
      ordered(frame.temperature, order)};
  if (frame.zone.empty()) return result;
  for (const std::size_t i : order) result.particles.scale.push_back(scale_of(frame.zone[i]));
  return result;
}

}  // namespace kappaflow
