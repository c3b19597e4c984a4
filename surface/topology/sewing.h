// Joins a patch with the rim of the hole that it is for. Private to this folder.
#pragma once

#include <vector>

#include "surface/topology/patch.h"

namespace kappaflow {

/// Joins every loop of the patch with one of the hole by a strip of triangles, and fills those that are left.
/// Pieces of the patch that would share a loop of the hole with a larger one are dropped.
Obstacles sew(const MeshEdits& edits, const Hole& hole, std::vector<Triangle>& patch,
              std::vector<Triangle>& seams);

/// Where the mesh with patch and seams in the hole would not be sound: a seam off the surface, an edge
/// without its two triangles, a new triangle that passes through another.
Obstacles unsound_places(const ReplacementSetting& setting, const MeshEdits& edits, const Hole& hole,
                         std::span<const Triangle> patch, std::span<const Triangle> seams);

}  // namespace kappaflow
