// Eq. 11: puts vertices back on f = 0.
#pragma once

#include <span>

#include "surface/field/field.h"

namespace kappaflow {

struct ProjectionOptions {
  double tolerance = 1e-4;     ///< stop when |f|/|g| is below this share of Field::length_scale()
  double step_limit = 0.25;    ///< longest single move, as a share of Field::length_scale()
  double reach = 1;            ///< longest total move, as a share of Field::length_scale(); beyond it the projection failed
  int iterations = 20;
};

/// One point on the surface, or why not.
struct Projected {
  Vec3 position;          ///< on the surface if converged, else where it was
  double residual = 0;    ///< |f|/|g| at position over Field::length_scale()
  bool converged = false;
};

/// Eq. 11, x <- x - f g/|g|^2, safeguarded: each move bounded, iterated to the tolerance, and the point left where it
/// was when g vanishes, the moves do not converge, or they lead further than the reach.
Projected project(const Field& field, const Vec3& x, const ProjectionOptions& options);

/// Projects every position in place; unprojected[v] is set to 1 where it failed, 0 elsewhere.
/// Returns the largest residual of those that converged.
double project_all(const Field& field, const ProjectionOptions& options, std::span<Vec3> position,
                   std::span<char> unprojected);

}  // namespace kappaflow
