// How far a surface moves from one instant to another, where nothing but its field is known.
#pragma once

#include "surface/field/field.h"

namespace kappaflow {

/// How far, in units of sigma [m], a surface moves between two of its fields: the distance to the first
/// surface that 95 % of the second surface's vertices keep within; 0 where one of them is empty. What moves
/// along the surface does not show. Throws as extract_isosurface does.
double surface_motion(const Field& before, const Field& after, double sigma);

}  // namespace kappaflow
