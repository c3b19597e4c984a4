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
bool drop_island(const Surroundings& near, const Loops& loops, std::size_t loop,
                 std::vector<Triangle>& patch) {
  const int first = static_cast<int>(near.vertex.size());
  std::vector<Triangle> own = patch;  // by the numbers of its own vertices
  for (Triangle& t : own)
    for (int& v : t) v -= first;
  const std::vector<int> piece = vertex_pieces(near.mesh.vertex_count() - first, own);
  const auto piece_of = [&](int v) { return piece[v - first]; };
  const int island = piece_of(loops[loop][0]);
  if (std::ranges::count_if(loops, [&](const auto& l) { return piece_of(l[0]) == island; }) > 1) return false;
  std::erase_if(patch, [&](const Triangle& t) { return piece_of(t[0]) == island; });
  return true;
}

/// loop_at: for each of the holes the loop of the patch that it is joined with, -1 where there is none.
Obstacles match_loops(const Surroundings& near, const Loops& holes, const Loops& loops,
                      std::vector<Triangle>& patch, std::vector<int>& loop_at) {
  const TriangleMesh& mesh = near.mesh;
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
    if (!drop_island(near, loops, larger ? taken : l, patch)) return places_of(mesh, holes[hole]);
    if (larger) taken = static_cast<int>(l);
  }
  return {};
}

}  // namespace

Obstacles sew(const Surroundings& near, const Hole& hole, std::vector<Triangle>& patch,
              std::vector<Triangle>& seams) {
  const TriangleMesh& mesh = near.mesh;
  const Loops holes = boundary_of(triangles_of(mesh, hole.removed)).loops, loops = boundary_of(patch).loops;
  std::vector<int> loop_at;
  if (Obstacles found = match_loops(near, holes, loops, patch, loop_at); !found.empty()) return found;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    if (loop_at[h] < 0 && holes[h].size() > kLongestFill) return places_of(mesh, holes[h]);
    const std::vector<Triangle> seam =
        loop_at[h] < 0 ? fill_loop(mesh.position, mesh.gradient, holes[h])
                       : strip_between(mesh.position, mesh.gradient, holes[h], loops[loop_at[h]]);
    seams.insert(seams.end(), seam.begin(), seam.end());
  }
  return {};
}

Obstacles seams_off_surface(const ReplacementSetting& setting, const Surroundings& near,
                            std::span<const Triangle> seams) {
  Obstacles found;
  for (const Triangle& t : seams)
    if (is_off_surface(setting.field, near.mesh.position, near.mesh.gradient, t, setting.off_surface))
      for (const int v : t) found.push_back(near.mesh.position[v]);
  return found;
}

Obstacles crossings(const Surroundings& near, const Hole& hole, std::span<const Triangle> patch,
                    std::span<const Triangle> seams) {
  std::vector<Triangle> all = triangles_of(near.mesh, hole.kept);
  const std::size_t kept = all.size();
  all.insert(all.end(), patch.begin(), patch.end());
  all.insert(all.end(), seams.begin(), seams.end());
  Obstacles found;
  for (const int t : intersecting_triangles(near.mesh.position, all, kept))
    for (const int v : all[t]) found.push_back(near.mesh.position[v]);
  return found;
}

}  // namespace kappaflow
