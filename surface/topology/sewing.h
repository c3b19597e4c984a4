// Joins a patch with the rim of the hole that it is for. Private to this folder.
#pragma once

#include <vector>

#include "surface/topology/patch.h"

namespace kappaflow {

/// Joins every loop of the patch with one of the hole by a strip of triangles, and fills those that are left.
/// Pieces of the patch that would share a loop of the hole with a larger one are dropped.
Obstacles sew(const Surroundings& near, const Hole& hole, std::vector<Triangle>& patch,
              std::vector<Triangle>& seams);

/// Where seams are off the surface.
Obstacles seams_off_surface(const ReplacementSetting& setting, const Surroundings& near,
                            std::span<const Triangle> seams);

/// Where a triangle of the patch or the seams passes through another or one that stays.
Obstacles crossings(const Surroundings& near, const Hole& hole, std::span<const Triangle> patch,
                    std::span<const Triangle> seams);

}  // namespace kappaflow
