// Extraction of f = 0 as a triangle mesh: the first mesh of a tracker, and the yardstick of the metrics.
#pragma once

#include <functional>
#include <span>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Points of a lattice from `first` to `last`, both included, and the cells between them.
struct LatticeBlock {
  std::array<int, 3> first{0, 0, 0}, last{-1, -1, -1};
};

/// The isosurface f = 0 of the field on a lattice of the given spacing [m]: closed, oriented outward, without
/// unreferenced vertices. Vertices lie where linear interpolation puts them: project them for more (see
/// projection.h). Empty where f < 0 everywhere. Throws InvalidInput when spacing is not positive or the
/// lattice would have more points than 2^31 near the surface. No more than about `points_at_once` of them are
/// held in memory; the result does not depend on it, but for rounding and the order of vertices and
/// triangles.
TriangleMesh extract_isosurface(const Field& field, double spacing,
                                std::size_t points_at_once = std::size_t{1} << 24);

/// The same of anything that fills the lattice's values, block by block; positive inside, and negative at the
/// lattice's outermost points.
TriangleMesh extract_isosurface(const SampledField& lattice, const std::function<void(SampledField&)>& sample,
                                std::size_t points_at_once = std::size_t{1} << 24);

/// The same from blocks, outside of which all is negative (see lattice_blocks.h). Where they are not the
/// whole lattice, vertices and triangles are in the order of the blocks.
TriangleMesh extract_isosurface(const SampledField& lattice, std::span<const LatticeBlock> blocks,
                                const std::function<void(SampledField&)>& sample);

/// The lattice of extract_isosurface(), without values: over the field's bounds, padded so that its outermost
/// points have f < 0. No points where the bounds are empty. Throws InvalidInput for more than 2^29 points
/// along an axis.
SampledField isosurface_lattice(const Field& field, double spacing);

/// Moves the vertices of extract_isosurface(field, spacing) along the lattice's edges onto f = 0, which the
/// false position method (Illinois) finds to `tolerance` [m]: in thin sheets linear interpolation may be half
/// a spacing off.
void place_on_surface(const Field& field, double spacing, double tolerance, std::span<Vec3> position);

}  // namespace kappaflow
