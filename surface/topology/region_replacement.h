// Takes one region of a mesh out and puts the isosurface in.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surface/mesh/edge_edits.h"
#include "surface/mesh/isosurface.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/topology.h"

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

/// A mesh under replacements: triangles taken out are kRemovedTriangle, vertices keep their numbers, new ones
/// of both come at the end.
class RegionReplacement {
 public:
  RegionReplacement(const ReplacementSetting& setting, TriangleMesh& mesh, VertexFacts facts)
      : setting_(setting), mesh_(mesh), facts_(facts) {}

  /// Replaces the mesh in the cells and those up to `growth` away; if that does not give a sound mesh, also
  /// where it was not, and so on. Returns whether one was reached; if not, the mesh is as it was.
  bool replace(std::span<const LatticeCell> cells, int growth);

  TopologyCounts counts;
  std::vector<LatticeBlock> replaced_blocks;  ///< around what each replacement touched

 private:
  bool replace(const CellRegion& region, const CellRegion& around);
  void take_out(const CellRegion& region, const CellRegion& around);
  bool smooth_rim();
  LatticeBlock block_around(const CellRegion& region) const;
  bool make_patch(const LatticeBlock& block, int finer, const CellRegion& region, LocalIsosurface& iso);
  bool patch_leaves_surface(const LocalIsosurface& iso) const;
  void cut_near_kept(const LocalIsosurface& iso);
  bool drop_foreign_pieces(const LocalIsosurface& iso, const CellRegion& region);
  void unpinch_patch();
  void append_vertices(const LocalIsosurface& iso);
  bool sew();
  bool drop_island(std::span<const std::vector<int>> loops, std::size_t loop);
  int matching_hole(std::span<const int> loop, std::span<const std::vector<int>> holes) const;
  bool is_sound();
  void blame(std::span<const int> vertices);
  void blame(const Vec3& x);
  void commit(const LatticeBlock& block);
  void roll_back();
  std::vector<VertexBlend> sources() const;
  std::vector<Triangle> triangles(std::span<const int> numbers) const;
  std::array<Vec3, 3> corners(const Triangle& t) const {
    return {mesh_.position[t[0]], mesh_.position[t[1]], mesh_.position[t[2]]};
  }

  const ReplacementSetting& setting_;
  TriangleMesh& mesh_;
  VertexFacts facts_;
  std::vector<int> removed_, kept_;      // triangles to take out, and those around that stay
  std::vector<Triangle> patch_;          // of the isosurface, first in its own numbers, then in the mesh's
  std::vector<Triangle> seams_;          // between patch and mesh
  std::size_t first_new_ = 0;            // vertex
  std::vector<char> exact_;              // of the new vertices
  std::vector<LatticeCell> in_the_way_;  // of a sound mesh, in the last attempt
};

}  // namespace kappaflow
