// The solids that a closed surface of one or several pieces encloses.
#pragma once

#include <span>
#include <vector>

#include "core/solid_distance.h"
#include "core/types.h"

namespace kappaflow {

/// Throws InvalidInput, which names a place, where a piece of the surface passes through itself, or a piece
/// that faces inward passes through another: solids_of() cannot tell inside from outside there. Pieces that
/// face outward may overlap. surface: closed, with its vertices shared by index.
void check_crossings(const TriangleSurface& surface);

/// The solids whose union a closed surface is, those of its points about which it winds a positive number of
/// times: one for each piece that faces outward, without the pieces facing inward (cavities) that lie in it
/// and in no smaller one. A surface of a single piece is returned as it is. Throws InvalidInput, which names
/// a place, for one of several pieces that faces inward and lies in no solid. surface: as check_crossings()
/// passes.
std::vector<TriangleSurface> solids_of(const TriangleSurface& surface);

/// Distances to the solids of all surfaces.
std::vector<SolidDistance> solid_distances(std::span<const TriangleSurface> surfaces);

}  // namespace kappaflow
