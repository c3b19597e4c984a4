#include "surface/topology/replacement.h"

#include <algorithm>
#include <cmath>

#include "core/nearest_on_triangle.h"
#include "core/triangle_tree.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/sewing.h"

namespace kappaflow {
namespace {

constexpr double kSurroundings = 2;  // reach of the triangles that a replacement looks at, in edge lengths
constexpr double kPatchCell = 0.5;   // largest cell of a patch's lattice, in edge lengths
constexpr int kAttempts = 12;        // at a region, each wider than the one before

/// Puts the patch's vertices behind those of the surroundings, by whose numbers its triangles go from here
/// on.
void place_vertices(Patch& patch, TriangleMesh& mesh, Replacement& result) {
  const LocalIsosurface& iso = patch.iso;
  std::vector<int> number(iso.position.size(), -1);
  for (Triangle& t : patch.triangles)
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(mesh.vertex_count());
        mesh.position.push_back(iso.position[v]);
        mesh.gradient.push_back(iso.gradient[v]);
        result.exact.push_back(iso.exact[v]);
      }
      v = number[v];
    }
}

/// Of each new vertex the nearest point of the triangles taken out; none where there were none.
std::vector<VertexBlend> origins_of_new(const Surroundings& near, std::span<const int> removed) {
  if (removed.empty()) return {};
  const auto corners = [&](const Triangle& t) {
    return TriangleTree::Corners{near.mesh.position[t[0]], near.mesh.position[t[1]],
                                 near.mesh.position[t[2]]};
  };
  std::vector<TriangleTree::Corners> taken_out;
  taken_out.reserve(removed.size());
  for (const int t : removed) taken_out.push_back(corners(near.mesh.triangles[t]));
  const TriangleTree tree(taken_out);
  std::vector<VertexBlend> origin;
  for (std::size_t v = near.vertex.size(); v < near.mesh.vertex_count(); ++v) {
    const auto nearest = tree.nearest(near.mesh.position[v]);
    const Triangle& t = near.mesh.triangles[removed[nearest.triangle]];
    const Vec3 weight = corner_weights(corners(t), nearest.at.point);
    origin.push_back(
        {{near.vertex[t[0]], near.vertex[t[1]], near.vertex[t[2]]}, {weight[0], weight[1], weight[2]}});
  }
  return origin;
}

/// What is exchanged, by the numbers of the whole mesh.
void set_exchange(const Surroundings& near, const Hole& hole, std::span<const Triangle> patch,
                  std::span<const Triangle> seams, std::size_t vertex_count, Replacement& result) {
  const int first_new = static_cast<int>(near.vertex.size());
  for (const int t : hole.removed) result.removed.push_back(near.triangle[t]);
  result.added.assign(patch.begin(), patch.end());
  result.added.insert(result.added.end(), seams.begin(), seams.end());
  for (Triangle& t : result.added)
    for (int& v : t) v = v < first_new ? near.vertex[v] : v - first_new + static_cast<int>(vertex_count);
  result.position.assign(near.mesh.position.begin() + first_new, near.mesh.position.end());
  result.gradient.assign(near.mesh.gradient.begin() + first_new, near.mesh.gradient.end());
}

/// Fills the hole with the patch, or says what is in the way.
Obstacles fill(const ReplacementSetting& setting, const MeshEdits& edits, const Hole& hole, Patch& patch,
               Surroundings& near, Replacement& result) {
  place_vertices(patch, near.mesh, result);
  std::vector<Triangle> seams;
  if (Obstacles found = sew(setting, near, hole, patch.triangles, seams); !found.empty()) return found;
  set_exchange(near, hole, patch.triangles, seams, edits.mesh().vertex_count(), result);
  Obstacles found;
  const auto add = [&](const Triangle& t) {
    for (const int v : t) found.push_back(near.mesh.position[v]);
  };
  const std::size_t of_patch = patch.triangles.size();
  for (const int t : edits.misfits(result.removed, result.added))
    add(t < static_cast<int>(of_patch) ? patch.triangles[t] : seams[t - of_patch]);
  if (!found.empty()) return found;
  if (found = crossings(near, hole, patch.triangles, seams); !found.empty()) return found;
  if (!edits.closes_rim(result.removed, result.added))
    for (const int t : hole.removed) add(near.mesh.triangles[t]);
  if (found.empty()) result.from = origins_of_new(near, hole.removed);
  return found;
}

/// Cells of a patch's lattice along one of the other lattice's, to begin with. An edge length that should be
/// twice the spacing may be a little less by rounding.
int finer_for_patches(const ReplacementSetting& setting) {
  const bool is_fine = setting.lattice.spacing <= 1.001 * kPatchCell * setting.edge_length;
  return is_fine && !setting.may_be_finer ? 1 : 2;
}

/// The smallest block that holds both.
LatticeBlock united(LatticeBlock a, const LatticeBlock& b) {
  for (int i = 0; i < 3; ++i) {
    a.first[i] = std::min(a.first[i], b.first[i]);
    a.last[i] = std::max(a.last[i], b.last[i]);
  }
  return a;
}

/// Adds a cell and those so far from it along the axes.
void add_around(const LatticeCell& cell, int distance, std::vector<LatticeCell>& cells) {
  cells.push_back(cell);
  for (int n = 0; n < 27 && distance > 0; ++n)
    cells.push_back({cell[0] + (n % 3 - 1) * distance, cell[1] + (n / 3 % 3 - 1) * distance,
                     cell[2] + (n / 9 - 1) * distance});
}

/// One attempt. region: to be replaced; around: of which triangles are looked at.
Obstacles attempt(const ReplacementSetting& setting, const CellRegion& region, const CellRegion& around,
                  const MeshEdits& edits, const VertexCells& vertices, Replacement& result) {
  result = {};
  result.read = around.block();
  Surroundings near = surroundings_of(edits, vertices, setting.lattice, around);
  Hole hole = hole_in(near.mesh, setting.lattice, region, around);
  if (Obstacles found = smooth_rim(near.mesh, hole); !found.empty()) return found;
  const LatticeBlock block = block_around(setting, near.mesh, hole, region);
  result.read = united(result.read, block);
  const int finer = finer_for_patches(setting);
  Patch patch;
  Obstacles found = make_patch(setting, near.mesh, hole, region, block, finer, patch);
  if (found.empty() && setting.may_be_finer && leaves_surface(setting, patch))
    found = make_patch(setting, near.mesh, hole, region, block, 2 * finer, patch);
  if (!found.empty()) return found;
  unpinch(patch.triangles);
  if (hole.removed.empty() && patch.triangles.empty()) return {};  // an earlier replacement has settled it
  result.changed = block;
  return fill(setting, edits, hole, patch, near, result);
}

}  // namespace

Replacement find_replacement(const ReplacementSetting& setting, std::span<const LatticeCell> cells,
                             int growth, const MeshEdits& edits, const VertexCells& vertices) {
  std::vector<LatticeCell> wider(cells.begin(), cells.end());
  const int surroundings =
      static_cast<int>(std::ceil(kSurroundings * setting.edge_length / setting.lattice.spacing));
  Replacement result;
  int further = 0;  // around what was in the way
  for (int n = 0; n < kAttempts; ++n) {
    const CellRegion region(wider, growth), around(wider, growth + surroundings);
    if (around.too_large()) {
      result.read = around.block();
      break;
    }
    std::vector<LatticeCell> in_the_way;
    for (const Vec3& x : attempt(setting, region, around, edits, vertices, result))
      in_the_way.push_back(cell_of(setting.lattice, x));
    result.is_sound = in_the_way.empty();
    if (result.is_sound) break;
    if (std::ranges::all_of(in_the_way, [&](const LatticeCell& c) { return region.has(c); })) ++further;
    for (const LatticeCell& c : in_the_way) add_around(c, further, wider);
  }
  return result;
}

}  // namespace kappaflow
