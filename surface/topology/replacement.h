// What of a mesh around one region is to be taken out, and what of the isosurface is to be put in. Private to
// this folder.
#pragma once

#include <span>
#include <vector>

#include "surface/mesh/mesh_edits.h"
#include "surface/topology/cell_region.h"
#include "surface/topology/vertex_cells.h"

namespace kappaflow {

/// What the replacements of one step share.
struct ReplacementSetting {
  const Field& field;
  const SampledField& lattice;  ///< its values are not read
  double edge_length;           ///< of the mesh [m]
  double tolerance;             ///< of new vertices [m]
  double off_surface;           ///< distance from f = 0 beyond which a triangle is not wanted [m]
  double seam_off_surface;      ///< the same of a seam, which remeshing may still refine [m]
  bool may_be_finer;            ///< whether patches whose chords miss a rim or tip are made finer
};

/// An exchange of triangles, not yet made.
struct Replacement {
  bool is_sound = false;          ///< whether there is one; nothing to exchange is sound, too
  LatticeBlock read;              ///< the mesh outside these cells makes no difference to it
  LatticeBlock changed;           ///< if it is sound: it makes no difference to the mesh outside these
  std::vector<int> removed;       ///< triangles of the mesh
  std::vector<Triangle> added;    ///< vertices of the mesh and, numbered from its vertex_count(), new ones
  std::vector<Vec3> position;     ///< of the new vertices [m]
  std::vector<Vec3> gradient;     ///< of f there [1/m]
  std::vector<char> exact;        ///< whether they are on f = 0
  std::vector<VertexBlend> from;  ///< where they come from; empty: from nowhere
};

/// Finds one in the cells and those up to `growth` away; if that does not give a sound mesh, also where it
/// was not, and so on. Reads the mesh only. vertices: of the mesh.
Replacement find_replacement(const ReplacementSetting& setting, std::span<const LatticeCell> cells,
                             int growth, const MeshEdits& edits, const VertexCells& vertices);

}  // namespace kappaflow
