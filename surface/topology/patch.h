// The hole that a replacement makes in a mesh, and the patch of isosurface for it. Private to this folder.
#pragma once

#include <vector>

#include "surface/mesh/local_isosurface.h"
#include "surface/mesh/mesh_edits.h"
#include "surface/topology/replacement.h"
#include "surface/topology/vertex_cells.h"

namespace kappaflow {

/// Places where an attempt at a replacement failed, beyond which a wider one should reach; none: all is well.
using Obstacles = std::vector<Vec3>;

/// The part of a mesh around a region. Vertices and triangles have numbers of their own, in the mesh's order.
struct Surroundings {
  TriangleMesh mesh;          ///< places, gradients and triangles alone; vertices of a patch follow
  std::vector<int> vertex;    ///< the number of each in the whole mesh, ascending; without those of a patch
  std::vector<int> triangle;  ///< likewise
};

/// Triangles of the surroundings that are to be taken out, and those around that stay.
struct Hole {
  std::vector<int> removed, kept;
};

/// What is to be put in: triangles of an isosurface, first by its own vertices' numbers, then by those of the
/// surroundings.
struct Patch {
  LocalIsosurface iso;
  std::vector<Triangle> triangles;
};

/// The triangles of the mesh with a corner in `around`.
Surroundings surroundings_of(const MeshEdits& edits, const VertexCells& vertices, const SampledField& lattice,
                             const CellRegion& around);

std::vector<Triangle> triangles_of(const TriangleMesh& mesh, std::span<const int> numbers);

/// The triangles with a corner in the region, and those with one in `around` that stay.
Hole hole_in(const TriangleMesh& mesh, const SampledField& lattice, const CellRegion& region,
             const CellRegion& around);

/// Takes more out until no vertex joins two loops of the hole's rim, and no triangle juts out into it.
Obstacles smooth_rim(const TriangleMesh& mesh, Hole& hole);

/// All that a patch for the hole may consist of, and some cells more.
LatticeBlock block_around(const ReplacementSetting& setting, const TriangleMesh& mesh, const Hole& hole,
                          const CellRegion& region);

/// Follows f = 0 from the region and the hole up to the triangles that stay, on a lattice that is finer by a
/// whole number. Its points are the lattice's and others between them: what agrees with one agrees with the
/// other.
Obstacles make_patch(const ReplacementSetting& setting, const TriangleMesh& mesh, const Hole& hole,
                     const CellRegion& region, const LatticeBlock& block, int finer, Patch& patch);

/// Whether a chord of the patch misses a rim or tip.
bool leaves_surface(const ReplacementSetting& setting, const Patch& patch);

/// Takes triangles out until no vertex joins two loops of the patch's boundary.
void unpinch(std::vector<Triangle>& patch);

}  // namespace kappaflow
