// A part of the isosurface f = 0, for what a mesh is to be repaired with.
#pragma once

#include <functional>
#include <span>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// The part of f = 0 in a block of a lattice; open where it leaves the block or ends before. One entry a
/// vertex but for triangles.
struct LocalIsosurface {
  std::vector<Vec3> position;  ///< [m]
  std::vector<Vec3> gradient;  ///< grad f there [1/m]
  std::vector<char> exact;     ///< 1 where |f|/|g| is below the tolerance
  std::vector<char> at_side;   ///< 1 on the block's sides
  std::vector<Triangle> triangles;
};

/// Whether the surface ends before a point of f = 0; arguments: x [m] and grad f there [1/m]. It is asked
/// from several threads at once.
using EndsAt = std::function<bool(const Vec3&, const Vec3&)>;

/// f = 0 as far as it hangs together with the cells `seeds`, by marching cubes (Lorensen & Cline 1987) from
/// cell to cell, with the table of extract_isosurface(); triangles with a corner at which it ends are left
/// out. Vertices lie on the lattice's edges, where the false position method (Illinois) finds f = 0 to
/// `tolerance` [m]: unlike Eq. 11 it succeeds also where surfaces are about to merge or to part and the
/// gradient vanishes. lattice: as isosurface_lattice() makes it. seeds: cells of the lattice by their lower
/// corners; those outside the block and those that f = 0 does not pass through are left out.
LocalIsosurface local_isosurface(const Field& field, const SampledField& lattice, const LatticeBlock& block,
                                 double tolerance, std::span<const std::array<int, 3>> seeds,
                                 const EndsAt& ends_at);

}  // namespace kappaflow
