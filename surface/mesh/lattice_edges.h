// f = 0 on the edges of a lattice, for those who extract it there. Private to this folder.
#pragma once

#include "surface/field/field.h"

namespace kappaflow {

/// A place where f = 0 crosses an edge of a lattice.
struct LatticeVertex {
  Vec3 position, gradient;  ///< [m], of f [1/m]
  bool exact;               ///< whether |f|/|g| is below the tolerance
};

/// f = 0 between two points of a lattice at which the signs of f differ; x: a guess between them. By one step
/// of Newton's method along the edge or, where that does not suffice, by false position (Illinois).
LatticeVertex find_on_edge(const Field& field, const Vec3& x, const Vec3& from, const Vec3& to,
                           double tolerance);

/// Moves samples of zero, which would put several vertices on one point, a little off it; plane by plane, so
/// that a plane which two slabs share gets the same values in both.
void move_off_zero(SampledField& samples);

}  // namespace kappaflow
