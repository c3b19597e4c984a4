// Where a mesh and the surface f = 0 that it stands for disagree.
#pragma once

#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/topology/cell_region.h"

namespace kappaflow {

/// The cell of the lattice that holds x.
LatticeCell cell_of(const SampledField& lattice, const Vec3& x);

/// The cells of corners and centroids of triangles of the mesh.
std::vector<LatticeCell> cells_of(const SampledField& lattice, const TriangleMesh& mesh,
                                  std::span<const int> triangles);

/// The sum of the unit outward normals of f = 0 at a triangle's corners. gradient: of f at the vertices.
Vec3 sum_of_normals(std::span<const Vec3> gradient, const Triangle& triangle);

/// Whether the normals at a triangle's corners, by their sum, agree well enough to tell where it should face.
bool normals_agree(const Vec3& sum_of_normals);

/// Whether the triangle is not a piece of f = 0 within `limit` [m]: by |f|/|g| > limit at its centroid, or
/// because it faces away from the field's normals at its corners, as their sum goes.
bool is_off_surface(const Field& field, std::span<const Vec3> position, std::span<const Vec3> gradient,
                    const Triangle& triangle, double limit);

/// The triangles for which is_off_surface() holds or a corner is not projected, ascending; but the
/// field is not asked about small triangles along which the normals at the corners hardly turn.
/// TriangleMesh::gradient must be that of the vertices as they are.
std::vector<int> triangles_off_surface(const Field& field, const TriangleMesh& mesh, double limit);

/// The cells at points of the lattice that are inside the mesh and not the surface, or the reverse, and
/// either further than `limit` [m] from f = 0, as f and its central differences tell, or from the mesh, or
/// not simple (is_simple()) in the surface's inside, or such that the mesh's inside cannot be deformed into
/// the surface's by simple points, one after the other: there a neck, slit, piece or hole is on the lattice
/// of one and not of the other. And those at points around which the mesh goes more than once, or backwards.
/// Only cells in the blocks are looked for, in their order. Of the lattice at most 2^22 points, or thin
/// slabs, are looked at by a task; its values are not read.
std::vector<LatticeCell> cells_in_dispute(const Field& field, const TriangleMesh& mesh, double limit,
                                          const SampledField& lattice, std::span<const LatticeBlock> blocks);

}  // namespace kappaflow
