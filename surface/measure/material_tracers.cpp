#include "surface/measure/material_tracers.h"

#include <algorithm>

#include "core/shared_loop.h"

namespace kappaflow {

MaterialTracers::MaterialTracers(std::span<const Vec3> position)
    : start_(position.begin(), position.end()),
      position_(start_),
      lost_(position.size(), 0),
      velocity_(position.size()) {}

void MaterialTracers::step(FieldMotion& motion) {
  position_t0_ = position_;
  runge_kutta_.advance(motion, TimeIntegrator::rk4, position_,
                       [&](const Field& field, std::span<const Vec3> position) -> std::span<const Vec3> {
                         shared_for(
                             position.size(),
                             [&](std::size_t i) {
                               const std::optional<Vec3> velocity =
                                   lost_[i] ? std::nullopt : field.material_velocity(position[i]);
                               lost_[i] = !velocity;
                               velocity_[i] = velocity.value_or(Vec3::Zero());
                             },
                             kDefaultGrain, lost_, velocity_);
                         return velocity_;
                       });
  for (std::size_t i = 0; i < position_.size(); ++i)
    if (lost_[i]) position_[i] = position_t0_[i];
}

std::size_t MaterialTracers::lost_count() const {
  return static_cast<std::size_t>(std::ranges::count(lost_, 1));
}

std::optional<double> tracer_distance(const TriangleMesh& mesh, const MaterialTracers& tracers,
                                      double sigma) {
  // Ids ascend, so the vertices of the first mesh come first.
  const std::size_t kept = vertices_older_than(mesh, static_cast<std::int64_t>(tracers.position().size()));
  const auto is_followed = [&](std::size_t v) { return !tracers.lost()[mesh.id[v]]; };
  const Vec2 sum = parallel_sum(kept, Vec2(Vec2::Zero()), [&](std::size_t v) -> Vec2 {
    if (!is_followed(v)) return Vec2::Zero();
    return {(mesh.position[v] - tracers.position()[mesh.id[v]]).norm(), 1};
  });
  if (sum[1] == 0) return std::nullopt;
  return sum[0] / (sum[1] * sigma);
}

}  // namespace kappaflow
