#include "surface/topology/region_replacement.h"

#include <algorithm>
#include <cmath>

#include "core/nearest_on_triangle.h"
#include "core/parallel.h"
#include "core/triangle_tree.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/sewing.h"

namespace kappaflow {
namespace {

constexpr double kSurroundings = 4;  // reach of the triangles that a replacement looks at, in edge lengths
constexpr int kFiner = 2;      // cells of a patch's lattice along one of the other lattice's, to begin with
constexpr int kAttempts = 12;  // at a region, each wider than the one before

/// Puts the patch's vertices on trial in the mesh, by whose numbers its triangles go from here on.
void place_vertices(Patch& patch, MeshEdits& edits) {
  const LocalIsosurface& iso = patch.iso;
  std::vector<int> number(iso.position.size(), -1);
  for (Triangle& t : patch.triangles)
    for (int& v : t) {
      if (number[v] < 0) number[v] = edits.try_vertex(iso.position[v], iso.gradient[v], iso.exact[v] != 0);
      v = number[v];
    }
}

/// Of each vertex on trial the nearest point of the triangles taken out; none where there were none.
std::vector<VertexBlend> origins_of_tried(const MeshEdits& edits, std::span<const int> removed) {
  if (removed.empty()) return {};
  const TriangleMesh& mesh = edits.mesh();
  const auto corners = [&](const Triangle& t) {
    return TriangleTree::Corners{mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]};
  };
  std::vector<TriangleTree::Corners> taken_out;
  taken_out.reserve(removed.size());
  for (const int t : removed) taken_out.push_back(corners(mesh.triangles[t]));
  const TriangleTree tree(taken_out);
  const std::size_t first = edits.first_tried();
  std::vector<VertexBlend> origin(mesh.vertex_count() - first);
  parallel_for(origin.size(), [&](std::size_t i) {
    const auto nearest = tree.nearest(mesh.position[first + i]);
    const Triangle& triangle = mesh.triangles[removed[nearest.triangle]];
    const Vec3 weight = corner_weights(corners(triangle), nearest.at.point);
    origin[i] = {triangle, {weight[0], weight[1], weight[2]}};
  });
  return origin;
}

/// Fills the hole with the patch, or says what is in the way and leaves the mesh as it is.
Obstacles fill(const ReplacementSetting& setting, const Hole& hole, Patch& patch, MeshEdits& edits) {
  place_vertices(patch, edits);
  std::vector<Triangle> seams;
  Obstacles found = sew(edits, hole, patch.triangles, seams);
  if (found.empty()) found = unsound_places(setting, edits, hole, patch.triangles, seams);
  if (found.empty()) {
    std::vector<Triangle> added = patch.triangles;
    added.insert(added.end(), seams.begin(), seams.end());
    if (edits.exchange(hole.removed, added, origins_of_tried(edits, hole.removed))) return {};
    for (const int t : hole.removed)
      for (const int v : edits.mesh().triangles[t]) found.push_back(edits.at(v));
  }
  edits.discard_tried();
  return found;
}

/// One attempt. region: to be replaced; around: of which triangles are looked at.
Obstacles attempt(const ReplacementSetting& setting, const CellRegion& region, const CellRegion& around,
                  MeshEdits& edits, Replaced& replaced) {
  const TriangleMesh& mesh = edits.mesh();
  Hole hole = hole_in(mesh, setting.lattice, region, around);
  if (Obstacles found = smooth_rim(mesh, hole); !found.empty()) return found;
  const LatticeBlock block = block_around(setting, mesh, hole, region);
  Patch patch;
  Obstacles found = make_patch(setting, mesh, hole, region, block, kFiner, patch);
  if (found.empty() && setting.may_be_finer && leaves_surface(setting, patch))
    found = make_patch(setting, mesh, hole, region, block, 2 * kFiner, patch);
  if (!found.empty()) return found;
  unpinch(patch.triangles);
  if (hole.removed.empty() && patch.triangles.empty()) return {};  // an earlier replacement has settled it
  found = fill(setting, hole, patch, edits);
  if (!found.empty()) return found;
  replaced.blocks.push_back(block);
  ++replaced.regions;
  replaced.triangles_removed += hole.removed.size();
  return {};
}

}  // namespace

bool replace_region(const ReplacementSetting& setting, std::span<const LatticeCell> cells, int growth,
                    MeshEdits& edits, Replaced& replaced) {
  std::vector<LatticeCell> wider(cells.begin(), cells.end());
  const int surroundings =
      static_cast<int>(std::ceil(kSurroundings * setting.edge_length / setting.lattice.spacing));
  for (int n = 0; n < kAttempts; ++n) {
    const CellRegion region(wider, growth), around(wider, growth + surroundings);
    if (around.too_large()) return false;
    std::vector<LatticeCell> in_the_way;
    for (const Vec3& x : attempt(setting, region, around, edits, replaced))
      in_the_way.push_back(cell_of(setting.lattice, x));
    if (in_the_way.empty()) return true;
    if (std::ranges::all_of(in_the_way, [&](const LatticeCell& c) { return region.has(c); })) ++growth;
    wider.insert(wider.end(), in_the_way.begin(), in_the_way.end());
  }
  return false;
}

}  // namespace kappaflow
