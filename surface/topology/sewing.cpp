#include "surface/topology/sewing.h"

#include <algorithm>
#include <limits>

#include "core/connectivity.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/loops.h"

namespace kappaflow {
namespace {

constexpr std::size_t kLongestFill = 80;  // corners of a loop that is filled

using Loops = std::vector<std::vector<int>>;

Obstacles places_of(const TriangleMesh& mesh, std::span<const int> vertices) {
  Obstacles places;
  for (const int v : vertices) places.push_back(mesh.position[v]);
  return places;
}

/// The hole to which most of the loop's vertices are nearest, on the same side of the liquid; -1 without any.
int matching_hole(const TriangleMesh& mesh, std::span<const int> loop, const Loops& holes) {
  std::vector<int> votes(holes.size(), 0);
  for (const int v : loop) {
    double least = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (std::size_t h = 0; h < holes.size(); ++h)
      for (const int w : holes[h]) {
        const double distance = (mesh.position[w] - mesh.position[v]).squaredNorm();
        if (!(distance < least) || !(mesh.gradient[w].dot(mesh.gradient[v]) > 0)) continue;
        least = distance;
        nearest = static_cast<int>(h);
      }
    if (nearest >= 0) ++votes[nearest];
  }
  const auto most = std::ranges::max_element(votes);
  return most == votes.end() || *most == 0 ? -1 : static_cast<int>(most - votes.begin());
}

/// Takes a piece of the patch with no other loop than this one away.
bool drop_island(const MeshEdits& edits, const Loops& loops, std::size_t loop, std::vector<Triangle>& patch) {
  const int first = static_cast<int>(edits.first_tried());
  std::vector<Triangle> own = patch;  // by the numbers of the vertices on trial
  for (Triangle& t : own)
    for (int& v : t) v -= first;
  const std::vector<int> piece = vertex_pieces(edits.mesh().vertex_count() - first, own);
  const auto piece_of = [&](int v) { return piece[v - first]; };
  const int island = piece_of(loops[loop][0]);
  if (std::ranges::count_if(loops, [&](const auto& l) { return piece_of(l[0]) == island; }) > 1) return false;
  std::erase_if(patch, [&](const Triangle& t) { return piece_of(t[0]) == island; });
  return true;
}

/// loop_at: for each of the holes the loop of the patch that it is joined with, -1 where there is none.
Obstacles match_loops(const MeshEdits& edits, const Loops& holes, const Loops& loops,
                      std::vector<Triangle>& patch, std::vector<int>& loop_at) {
  const TriangleMesh& mesh = edits.mesh();
  loop_at.assign(holes.size(), -1);
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const int hole = matching_hole(mesh, loops[l], holes);
    if (hole < 0) return places_of(mesh, loops[l]);
    int& taken = loop_at[hole];
    if (taken < 0) {
      taken = static_cast<int>(l);
      continue;
    }
    const bool larger = loops[l].size() > loops[taken].size();
    if (!drop_island(edits, loops, larger ? taken : l, patch)) return places_of(mesh, holes[hole]);
    if (larger) taken = static_cast<int>(l);
  }
  return {};
}

}  // namespace

Obstacles sew(const MeshEdits& edits, const Hole& hole, std::vector<Triangle>& patch,
              std::vector<Triangle>& seams) {
  const TriangleMesh& mesh = edits.mesh();
  const Loops holes = boundary_of(triangles_of(mesh, hole.removed)).loops, loops = boundary_of(patch).loops;
  std::vector<int> loop_at;
  if (Obstacles found = match_loops(edits, holes, loops, patch, loop_at); !found.empty()) return found;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    if (loop_at[h] < 0 && holes[h].size() > kLongestFill) return places_of(mesh, holes[h]);
    const std::vector<Triangle> seam =
        loop_at[h] < 0 ? fill_loop(mesh.position, mesh.gradient, holes[h])
                       : strip_between(mesh.position, mesh.gradient, holes[h], loops[loop_at[h]]);
    seams.insert(seams.end(), seam.begin(), seam.end());
  }
  return {};
}

Obstacles unsound_places(const ReplacementSetting& setting, const MeshEdits& edits, const Hole& hole,
                         std::span<const Triangle> patch, std::span<const Triangle> seams) {
  const TriangleMesh& mesh = edits.mesh();
  Obstacles found;
  const auto add = [&](const Triangle& t) {
    for (const int v : t) found.push_back(mesh.position[v]);
  };
  for (const Triangle& t : seams)
    if (is_off_surface(setting.field, mesh.position, mesh.gradient, t, setting.off_surface)) add(t);
  if (!found.empty()) return found;
  std::vector<Triangle> all = triangles_of(mesh, hole.kept);
  const std::size_t kept = all.size();
  all.insert(all.end(), patch.begin(), patch.end());
  all.insert(all.end(), seams.begin(), seams.end());
  for (const int t : edits.misfits(hole.removed, std::span(all).subspan(kept))) add(all[kept + t]);
  if (!found.empty()) return found;
  for (const int t : intersecting_triangles(mesh.position, all, kept)) add(all[t]);
  return found;
}

}  // namespace kappaflow
