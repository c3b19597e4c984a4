#include "surface/field/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/shared_loop.h"

namespace kappaflow {
namespace {

constexpr std::size_t kGrain = 64;  // points of a task: each is several evaluations of the field

double residual(const ValueAndGradient& at, double length_scale) {
  const double slope = at.g.norm();
  return slope > 0 ? std::abs(at.f) / slope / length_scale : std::numeric_limits<double>::infinity();
}

/// -f g/|g|^2, shortened to `longest`.
Vec3 newton_move(const ValueAndGradient& at, double longest) {
  const double slope = at.g.norm();
  return at.g / slope * std::clamp(-at.f / slope, -longest, longest);
}

}  // namespace

Projected project(const Field& field, const Vec3& x, const ProjectionOptions& options) {
  const double scale = field.length_scale();
  if (!x.allFinite()) return {.position = x, .residual = std::numeric_limits<double>::infinity()};
  ValueAndGradient at = field.value_and_gradient(x);
  Projected failed{.position = x, .gradient = at.g, .residual = residual(at, scale)};

  Vec3 y = x;
  double y_residual = failed.residual, longest = options.step_limit * scale;
  for (int evaluations = 1; !(y_residual <= options.tolerance); ++evaluations) {
    if (evaluations > options.iterations || !std::isfinite(y_residual)) return failed;
    const Vec3 trial = y + newton_move(at, longest);
    if ((trial - x).norm() > options.reach * scale) return failed;
    const ValueAndGradient at_trial = field.value_and_gradient(trial);
    if (std::abs(at_trial.f) < std::abs(at.f)) {
      y = trial;
      at = at_trial;
      y_residual = residual(at, scale);
      longest = std::min(2 * longest, options.step_limit * scale);
    } else {
      longest = 0.5 * (trial - y).norm();
    }
  }
  return {.position = y, .gradient = at.g, .residual = y_residual, .converged = true};
}

double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected, std::span<Vec3> gradient) {
  return shared_max(
      position.size(), 0.0,
      [&](std::size_t v) {
        const Projected projected = project(field, position[v], options);
        position[v] = projected.position;
        gradient[v] = projected.gradient;
        unprojected[v] = !projected.converged;
        return projected.converged ? projected.residual : 0.0;
      },
      kGrain, position, unprojected, gradient);
}

double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected) {
  std::vector<Vec3> gradient(position.size());
  return project_all(field, options, position, unprojected, gradient);
}

}  // namespace kappaflow
