// f = 0 on the edges of a lattice, for those who extract it there. Private to this folder.
#pragma once

#include <array>

#include "surface/field/field.h"

namespace kappaflow {

using LatticePoint = std::array<int, 3>;

/// An edge of a lattice: where it starts, and the axis along which it goes on.
struct LatticeEdge {
  LatticePoint from;
  int axis;
};

/// The edges of a cell, as the tables of marching cubes number them.
inline constexpr std::array<LatticeEdge, 12> kCellEdges{{{{0, 0, 0}, 0},
                                                         {{1, 0, 0}, 1},
                                                         {{0, 1, 0}, 0},
                                                         {{0, 0, 0}, 1},
                                                         {{0, 0, 1}, 0},
                                                         {{1, 0, 1}, 1},
                                                         {{0, 1, 1}, 0},
                                                         {{0, 0, 1}, 1},
                                                         {{0, 0, 0}, 2},
                                                         {{1, 0, 0}, 2},
                                                         {{0, 1, 0}, 2},
                                                         {{1, 1, 0}, 2}}};

inline LatticePoint moved(LatticePoint at, const LatticePoint& by) {
  for (int a = 0; a < 3; ++a) at[a] += by[a];
  return at;
}

/// Where the value of a point of the samples is.
inline std::size_t point_index(const SampledField& samples, const LatticePoint& p) {
  return (static_cast<std::size_t>(p[2]) * samples.dims[1] + p[1]) * samples.dims[0] + p[0];
}

/// The triangles of marching cubes in a cell of the samples, by three edges each, up to a -1.
const int* triangles_of_cell(const SampledField& samples, const LatticePoint& cell);

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
