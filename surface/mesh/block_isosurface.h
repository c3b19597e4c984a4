// Extraction of f = 0 from blocks of a lattice. Private to this folder.
#pragma once

#include <functional>
#include <span>

#include "surface/mesh/isosurface.h"

namespace kappaflow {

/// What extract_isosurface() makes of the whole lattice, but for rounding and the order of vertices and
/// triangles, from blocks that neighbour each other by their sides' points, and outside of which all is
/// negative: by marching cubes (Lorensen & Cline 1987).
TriangleMesh isosurface_in_blocks(const SampledField& lattice, std::span<const LatticeBlock> blocks,
                                  const std::function<void(SampledField&)>& sample);

}  // namespace kappaflow
