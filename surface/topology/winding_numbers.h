// How often a closed mesh goes around each point of a lattice, and what of it the lattice can tell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// The winding number of a closed oriented mesh at every point of the lattice (whose values are not read),
/// indexed as SampledField::value: 1 inside, 0 outside, others where the mesh passes through itself.
/// Crossings are counted along rows in x that lie 1.37e-7 and 2.91e-7 spacings beyond the points in y and z,
/// so that they miss vertices which lie on the lattice's edges. They are counted modulo 256: beyond -128 ...
/// 127 winding numbers wrap around. Where the lattice begins inside the mesh, crossings before its first
/// column count: triangles with other rows may be left out.
std::vector<std::int8_t> winding_numbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                         const SampledField& lattice);

/// The mesh as the points of a lattice see it: the isosurface (see extract_isosurface()) between those inside
/// and those outside. Pieces, necks, holes and slits that pass between the points are not on it. lattice: as
/// isosurface_lattice() makes it, with the mesh inside.
TriangleMesh seen_by_lattice(const TriangleMesh& mesh, const SampledField& lattice);

}  // namespace kappaflow
