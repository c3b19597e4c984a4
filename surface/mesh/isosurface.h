// Extraction of f = 0 as a triangle mesh: the first mesh of a tracker, and the yardstick of the metrics.
#pragma once

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// The isosurface f = 0 of the field on a lattice of the given spacing [m]: closed, oriented outward, without
/// unreferenced vertices. Vertices lie where linear interpolation puts them: project them for more (see
/// projection.h). Empty where f < 0 everywhere. Throws InvalidInput when spacing is not positive or the
/// lattice would have more points than 2^31. No more than about `points_at_once` of them are held in memory;
/// the result does not depend on it, but for rounding and the order of vertices and triangles.
TriangleMesh extract_isosurface(const Field& field, double spacing,
                                std::size_t points_at_once = std::size_t{1} << 24);

}  // namespace kappaflow
