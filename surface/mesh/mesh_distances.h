// Closed meshes as images of their distance: what makes a mesh of anybody's an implicit surface.
#pragma once

#include "core/types.h"
#include "surface/field/distance_field.h"

namespace kappaflow {

/// The signed distances from a closed surface at the points of a grid around it, whose origin is that of
/// space; further than `reach` [m] they are cut off. What of it is as
/// short as three spacings, as facets are of a mesh with edges like the spacing, is smoothed away. spacing:
/// of the grid [m]. surface: oriented outward, with vertices shared by index; pieces may overlap, and those
/// that face inward are cavities. Throws InvalidInput as check_crossings() and solids_of() do, and for a grid
/// of more than 2^31 points.
SignedDistances signed_distances(const TriangleSurface& surface, double spacing, double reach);

}  // namespace kappaflow
