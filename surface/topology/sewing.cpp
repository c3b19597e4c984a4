#include "surface/topology/sewing.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/connectivity.h"
#include "core/sort_unique.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/loops.h"

namespace kappaflow {
namespace {

constexpr std::size_t kLongestFill = 80;  // corners of a loop that is filled
constexpr double kFarLoop = 1;  // mean distance of a loop from the hole that it is in, in edge lengths
constexpr double kLongestEdges[] = {1.5, 3};  // of a seam's triangles, in edge lengths: first, and else
constexpr int kFills = 4;  // of a hole, without the triangles off the surface of those before

using Loops = std::vector<std::vector<int>>;

Obstacles places_of(const TriangleMesh& mesh, std::span<const int> vertices) {
  Obstacles places;
  for (const int v : vertices) places.push_back(mesh.position[v]);
  return places;
}

/// The hole to which most of the loop's vertices are nearest, on the same side of the liquid; -1 where they
/// are further than `reach` [m] from all, in the mean: mesh and patch overlap there.
int matching_hole(const TriangleMesh& mesh, std::span<const int> loop, const Loops& holes, double reach) {
  std::vector<int> votes(holes.size(), 0);
  double sum = 0;
  for (const int v : loop) {
    double least = kInfinity;
    int nearest = -1;
    for (std::size_t h = 0; h < holes.size(); ++h)
      for (const int w : holes[h]) {
        const double distance = (mesh.position[w] - mesh.position[v]).squaredNorm();
        if (!(distance < least) || !(mesh.gradient[w].dot(mesh.gradient[v]) > 0)) continue;
        least = distance;
        nearest = static_cast<int>(h);
      }
    if (nearest >= 0) ++votes[nearest];
    sum += std::sqrt(least);
  }
  if (!(sum <= reach * static_cast<double>(loop.size()))) return -1;
  return static_cast<int>(std::ranges::max_element(votes) - votes.begin());
}

/// inside: for each of the holes the loops of the patch that it is joined with.
Obstacles match_loops(const ReplacementSetting& setting, const TriangleMesh& mesh, const Loops& holes,
                      const Loops& loops, std::vector<Loops>& inside) {
  inside.resize(holes.size());
  Obstacles found;
  for (const std::vector<int>& loop : loops) {
    const int hole = matching_hole(mesh, loop, holes, kFarLoop * setting.edge_length);
    if (hole >= 0)
      inside[hole].push_back(loop);
    else
      std::ranges::copy(places_of(mesh, loop), std::back_inserter(found));
  }
  return found;
}

/// Edges between vertices of the loops that triangles have which stay around the holes, or those of the
/// patch.
std::vector<std::pair<int, int>> taken_edges(const TriangleMesh& mesh, const Hole& hole,
                                             std::span<const Triangle> patch, const Loops& holes,
                                             const Loops& loops) {
  std::vector<char> on_loop(mesh.vertex_count(), 0);
  for (const Loops* of : {&holes, &loops})
    for (const std::vector<int>& loop : *of)
      for (const int v : loop) on_loop[v] = 1;
  std::vector<std::pair<int, int>> edges;
  const auto add = [&](const Triangle& t) {
    for (int c = 0; c < 3; ++c)
      if (const auto [u, v] = std::minmax(t[c], t[(c + 1) % 3]); on_loop[u] && on_loop[v])
        edges.emplace_back(u, v);
  };
  for (const int t : hole.kept) add(mesh.triangles[t]);
  for (const Triangle& t : patch) add(t);
  sort_unique(edges);
  return edges;
}

/// Triangles that fill a hole, and those of them that are off the surface.
struct Seam {
  std::vector<Triangle> triangles, off;
};

/// By edges as short as they may be.
Seam fill(const ReplacementSetting& setting, const TriangleMesh& mesh, std::span<const int> polygon,
          FillRules& rules) {
  Seam seam;
  for (const double longest : kLongestEdges) {
    rules.longest_edge = longest * setting.edge_length;
    seam.triangles = fill_polygon(mesh.position, mesh.gradient, polygon, rules);
    if (!seam.triangles.empty()) break;
  }
  std::ranges::copy_if(seam.triangles, std::back_inserter(seam.off), [&](const Triangle& t) {
    return is_off_surface(setting.field, mesh.position, mesh.gradient, t, setting.seam_off_surface);
  });
  return seam;
}

/// The same; triangles that are off the surface are refused, and others looked for.
Seam fill_on_surface(const ReplacementSetting& setting, const TriangleMesh& mesh,
                     std::span<const int> polygon, FillRules& rules) {
  rules.refused.clear();
  Seam best = fill(setting, mesh, polygon, rules), seam = best;
  for (int n = 1; n < kFills && !seam.off.empty(); ++n) {
    for (Triangle& t : seam.off) std::ranges::sort(t);
    rules.refused.insert(rules.refused.end(), seam.off.begin(), seam.off.end());
    sort_unique(rules.refused);
    seam = fill(setting, mesh, polygon, rules);
    if (seam.off.size() < best.off.size()) best = seam;
  }
  return best;
}

}  // namespace

Obstacles sew(const ReplacementSetting& setting, const Surroundings& near, const Hole& hole,
              std::span<const Triangle> patch, std::vector<Triangle>& seams) {
  const TriangleMesh& mesh = near.mesh;
  const Loops holes = boundary_of(triangles_of(mesh, hole.removed)).loops, loops = boundary_of(patch).loops;
  std::vector<Loops> inside;
  if (Obstacles found = match_loops(setting, mesh, holes, loops, inside); !found.empty()) return found;
  FillRules rules;
  rules.taken_edges = taken_edges(mesh, hole, patch, holes, loops);
  Obstacles found;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    if (inside[h].empty() && holes[h].size() > kLongestFill) return places_of(mesh, holes[h]);
    const std::vector<int> polygon = bridged_polygon(mesh.position, mesh.gradient, holes[h], inside[h]);
    const Seam seam = fill_on_surface(setting, mesh, polygon, rules);
    if (seam.triangles.empty()) return places_of(mesh, holes[h]);
    seams.insert(seams.end(), seam.triangles.begin(), seam.triangles.end());
    for (const Triangle& t : seam.off)
      for (const int v : t) found.push_back(mesh.position[v]);
  }
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
