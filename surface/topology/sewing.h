// Joins a patch with the rim of the hole that it is for by seams. Private to this folder.
#pragma once

#include <vector>

#include "surface/topology/patch.h"

namespace kappaflow {

/// Fills each of the hole's loops around those of the patch that are in it. Obstacles are the seams that are
/// off the surface, and loops that fit nowhere.
Obstacles sew(const ReplacementSetting& setting, const Surroundings& near, const Hole& hole,
              std::span<const Triangle> patch, std::vector<Triangle>& seams);

/// Where a triangle of the patch or the seams passes through another or one that stays.
Obstacles crossings(const Surroundings& near, const Hole& hole, std::span<const Triangle> patch,
                    std::span<const Triangle> seams);

}  // namespace kappaflow
