// Takes one region of a mesh out and puts the isosurface in.
#pragma once

#include <span>
#include <vector>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_edits.h"
#include "surface/topology/cell_region.h"

namespace kappaflow {

/// What the replacements of one step share.
struct ReplacementSetting {
  const Field& field;
  const SampledField& lattice;  ///< its values are not read
  double edge_length;           ///< of the mesh [m]
  double tolerance;             ///< of new vertices [m]
  double off_surface;           ///< distance from f = 0 beyond which a new triangle is not wanted [m]
  bool may_be_finer;            ///< whether patches whose chords miss a rim or tip are made finer
};

/// What was replaced.
struct Replaced {
  std::size_t regions = 0;
  std::size_t triangles_removed = 0;
  std::vector<LatticeBlock> blocks;  ///< around what each replacement touched
};

/// Replaces the mesh in the cells and those up to `growth` away; if that does not give a sound mesh, also
/// where it was not, and so on. Returns whether one was reached; if not, the mesh is as it was.
bool replace_region(const ReplacementSetting& setting, std::span<const LatticeCell> cells, int growth,
                    MeshEdits& edits, Replaced& replaced);

}  // namespace kappaflow
