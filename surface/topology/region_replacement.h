// Takes regions of a mesh out and puts the isosurface in.
#pragma once

#include <vector>

#include "surface/topology/replacement.h"

namespace kappaflow {

/// What was replaced.
struct Replaced {
  std::size_t regions = 0;
  std::size_t triangles_removed = 0;
  std::vector<LatticeBlock> blocks;   ///< around what each replacement touched
  std::vector<LatticeBlock> refused;  ///< around regions that stay as they were
  std::vector<LatticeBlock> failed;   ///< around all that ever were, whatever a later call made of them
};

/// Replaces the mesh in each of the regions and up to `growth` cells around, wider where that is needed.
/// Replacements that do not depend on each other are found in parallel and made in the order of the regions;
/// the others wait for a later round: results do not depend on the threads. Those that stay as they were,
/// because no sound mesh was found, are refused; one that was before and is near a region of this call is
/// not. vertices: of the mesh, some or all; new ones are entered.
void replace_regions(const ReplacementSetting& setting, const std::vector<std::vector<LatticeCell>>& regions,
                     int growth, MeshEdits& edits, VertexCells& vertices, Replaced& replaced);

}  // namespace kappaflow
