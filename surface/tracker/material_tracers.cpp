#include "surface/tracker/material_tracers.h"

#include <algorithm>

namespace kappaflow {

MaterialTracers::MaterialTracers(std::span<const Vec3> position)
    : position_(position.begin(), position.end()), lost_(position.size(), 0), velocity_(position.size()) {}

void MaterialTracers::step(FieldMotion& motion) {
  position_t0_ = position_;
  runge_kutta_.advance(motion, TimeIntegrator::rk4, position_,
                       [&](const Field& field, std::span<const Vec3> position) -> std::span<const Vec3> {
                         parallel_for(position.size(), [&](std::size_t i) {
                           const std::optional<Vec3> velocity =
                               lost_[i] ? std::nullopt : field.material_velocity(position[i]);
                           lost_[i] = !velocity;
                           velocity_[i] = velocity.value_or(Vec3::Zero());
                         });
                         return velocity_;
                       });
  for (std::size_t i = 0; i < position_.size(); ++i)
    if (lost_[i]) position_[i] = position_t0_[i];
}

std::size_t MaterialTracers::lost_count() const {
  return static_cast<std::size_t>(std::ranges::count(lost_, 1));
}

std::optional<double> tracer_distance(std::span<const Vec3> vertex_position, const MaterialTracers& tracers,
                                      double sigma) {
  const std::size_t n = vertex_position.size(), followed = n - tracers.lost_count();
  if (followed == 0) return std::nullopt;
  const double sum = parallel_sum(n, 0.0, [&](std::size_t i) {
    return tracers.lost()[i] ? 0.0 : (vertex_position[i] - tracers.position()[i]).norm();
  });
  return sum / (static_cast<double>(followed) * sigma);
}

}  // namespace kappaflow
