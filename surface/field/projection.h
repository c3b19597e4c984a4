// Eq. 11: puts vertices back on f = 0.
#pragma once

#include <span>

#include "surface/field/field.h"

namespace kappaflow {

struct ProjectionOptions {
  double tolerance = 1e-4;   ///< stop when |f|/|g| is below this share of Field::length_scale()
  double step_limit = 0.25;  ///< longest single move, as a share of Field::length_scale()
  double reach = 1;          ///< longest total move, as a share of Field::length_scale(); beyond: failure
  int iterations = 20;       ///< evaluations after the first
};

/// One point on the surface, or the point itself where there is none in reach.
struct Projected {
  Vec3 position;                 ///< on the surface if converged, else where it was [m]
  Vec3 gradient = Vec3::Zero();  ///< grad f at position [1/m]
  double residual = 0;           ///< |f|/|g| there over Field::length_scale(); infinite where g vanishes
  bool converged = false;
};

/// Eq. 11, x <- x - f g/|g|^2, safeguarded: each move is bounded and accepted only where it reduces |f|,
/// iterated to the tolerance; the point is left where it was when g vanishes, the moves do not converge, or
/// they lead further than the reach. One evaluation of the field where x is within the tolerance already.
Projected project(const Field& field, const Vec3& x, const ProjectionOptions& options);

/// Projects every position in place; unprojected[v] is set to 1 where it failed, 0 elsewhere, and gradient[v]
/// to grad f at the new position. Returns the largest residual of those that converged.
double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected, std::span<Vec3> gradient);
/// All, without the gradients.
double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected);

}  // namespace kappaflow
