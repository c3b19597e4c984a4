// Shapes of walls as triangle surfaces, and shapes of liquid as sets of points.
#pragma once

#include <vector>

#include "scenes/scene.h"

namespace kappaflow {

/// Closed, manifold, without T-junctions, oriented outward. Requires lower < upper in every component.
TriangleSurface box_surface(const BoxShape& box);

/// Likewise; facets of about 6 degrees, the vertices on the sphere or the cylinder. Requires radius > 0, from
/// != to.
TriangleSurface sphere_surface(const SphereShape& sphere);
TriangleSurface cylinder_surface(const CylinderShape& cylinder);

/// Likewise, one solid. Requires lower < upper in every component, thickness > 0.
TriangleSurface basin_surface(const BasinShape& basin);

/// Likewise, one solid for the whole flight. Requires steps >= 1 and every length > 0.
TriangleSurface stairs_surface(const StairsShape& stairs);

/// [m2]
double surface_area(const BoxShape& box);
double surface_area(const SphereShape& sphere);
double surface_area(const TriangleSurface& surface);

/// An upper bound of the number of lattice points of the shape, as a number that cannot overflow.
double lattice_size(const BoxShape& box, double spacing);
double lattice_size(const SphereShape& sphere, double spacing);
double lattice_size(const TriangleSurface& solid, double spacing);

/// Points of a cubic lattice in the shape, x-fastest: in a box at lower + (i + 1/2) spacing with all cells
/// inside the box, in a sphere at center + (i + 1/2) spacing no further than the radius, in a closed surface,
/// as solids_of() takes it, at lower + (i + 1/2) spacing, with lower the corner of its bounding box, and
/// inside one of its solids.
std::vector<Vec3> lattice_points(const BoxShape& box, double spacing);
std::vector<Vec3> lattice_points(const SphereShape& sphere, double spacing);
std::vector<Vec3> lattice_points(const TriangleSurface& solid, double spacing);

}  // namespace kappaflow
