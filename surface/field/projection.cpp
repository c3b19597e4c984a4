#include "surface/field/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

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

/// The vertices vertex_of(0) to vertex_of(n - 1).
template <class VertexOf>
double project_each(std::size_t n, const VertexOf& vertex_of, const Field& field,
                    const ProjectionOptions& options, std::span<Vec3> position, std::span<char> unprojected,
                    std::span<Vec3> gradient) {
  return parallel_reduce(
      n, 0.0,
      [&](std::size_t k) {
        const std::size_t v = vertex_of(k);
        const Projected projected = project(field, position[v], options);
        position[v] = projected.position;
        gradient[v] = projected.gradient;
        unprojected[v] = !projected.converged;
        return projected.converged ? projected.residual : 0.0;
      },
      [](double a, double b) { return std::max(a, b); }, kGrain);
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
  return project_each(
      position.size(), [](std::size_t v) { return v; }, field, options, position, unprojected, gradient);
}

double project_some(const Field& field, const ProjectionOptions& options, std::span<const int> which,
                    std::span<Vec3> position, std::span<char> unprojected, std::span<Vec3> gradient) {
  return project_each(
      which.size(), [&](std::size_t k) { return static_cast<std::size_t>(which[k]); }, field, options,
      position, unprojected, gradient);
}

double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected) {
  std::vector<Vec3> gradient(position.size());
  return project_all(field, options, position, unprojected, gradient);
}

}  // namespace kappaflow
