#include "surface/topology/patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/connectivity.h"
#include "core/nearest_on_triangle.h"
#include "core/parallel.h"
#include "core/triangle_geometry.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/triangle_bins.h"

namespace kappaflow {
namespace {

constexpr double kGap = 0.25;              // between the mesh and the patch, in edge lengths
constexpr double kSameSide = 0.2;          // least cosine between normals of one sheet
constexpr int kSidePadding = 2;            // cells between all that matters and the block's sides
constexpr int kRimRounds = 20;             // of smoothing the rim
constexpr std::size_t kSmallestPiece = 3;  // triangles of a patch that is worth sewing in

bool has_vertex(const Triangle& t, std::span<const int> sorted_vertices) {
  return std::ranges::any_of(t, [&](int v) { return std::ranges::binary_search(sorted_vertices, v); });
}

/// The edges of loops, sorted.
std::vector<std::pair<int, int>> edges_of(std::span<const std::vector<int>> loops) {
  std::vector<std::pair<int, int>> edges;
  for (const std::vector<int>& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
  std::ranges::sort(edges);
  return edges;
}

/// Whether several of the triangle's edges run against one of the sorted edges.
bool has_edges_along(const Triangle& t, std::span<const std::pair<int, int>> edges) {
  const auto begins = [&](int v) {  // two edges begin at two corners; most triangles' corners are on none
    const auto edge = std::ranges::lower_bound(edges, std::pair(v, -1));
    return edge != edges.end() && edge->first == v;
  };
  if (!begins(t[0]) && !begins(t[1])) return false;
  int along = 0;
  for (int c = 0; c < 3; ++c) along += std::ranges::binary_search(edges, std::pair(t[(c + 1) % 3], t[c]));
  return along >= 2;
}

/// Whether x is in the triangle's box, widened by `reach`.
bool is_near_box(const std::array<Vec3, 3>& corner, const Vec3& x, double reach) {
  const auto& [a, b, c] = corner;
  return (x.array() >= a.cwiseMin(b).cwiseMin(c).array() - reach).all() &&
         (x.array() <= a.cwiseMax(b).cwiseMax(c).array() + reach).all();
}

/// Those of the triangles that come within `reach` of the box around some points.
std::vector<int> near_box(const TriangleMesh& mesh, std::span<const int> triangles,
                          std::span<const Vec3> points, double reach) {
  Vec3 lower = Vec3::Constant(kInfinity), upper = -lower;
  for (const Vec3& x : points) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  std::vector<int> near;
  for (const int t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &x = mesh.position[a], &y = mesh.position[b], &z = mesh.position[c];
    if ((x.cwiseMin(y).cwiseMin(z).array() - reach <= upper.array()).all() &&
        (x.cwiseMax(y).cwiseMax(z).array() + reach >= lower.array()).all())
      near.push_back(t);
  }
  return near;
}

/// The patch is what of the isosurface keeps a distance from the mesh that stays.
std::vector<Triangle> away_from_kept(const LocalIsosurface& iso, const TriangleMesh& mesh,
                                     std::span<const int> kept, double gap) {
  const TriangleBins bins(mesh, near_box(mesh, kept, iso.position, gap), gap);
  std::vector<char> near(iso.position.size());
  parallel_for(near.size(), [&](std::size_t v) {
    const Vec3 normal = -iso.gradient[v].normalized();
    near[v] = bins.any_near(iso.position[v], [&](int t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const std::array<Vec3, 3> at{mesh.position[a], mesh.position[b], mesh.position[c]};
      return is_near_box(at, iso.position[v], gap) &&
             (nearest_on_triangle(at, iso.position[v]).point - iso.position[v]).norm() <= gap &&
             twice_area_vector(at[0], at[1], at[2]).normalized().dot(normal) > kSameSide;
    });
  });
  std::vector<Triangle> patch;
  for (const Triangle& t : iso.triangles)
    if (std::ranges::none_of(t, [&](int v) { return near[v]; })) patch.push_back(t);
  return patch;
}

/// Pieces of the patch that end at the block's side belong to another region, unless they reach into this
/// one: then the block is too small. So do closed ones outside; and specks go.
Obstacles drop_foreign_pieces(const SampledField& lattice, const CellRegion& region, Patch& patch) {
  const LocalIsosurface& iso = patch.iso;
  const std::vector<int> piece = vertex_pieces(iso.position.size(), patch.triangles);
  std::vector<char> ends_at_side(piece.size(), 0), in_region(piece.size(), 0), open(piece.size(), 0);
  std::vector<std::size_t> size(piece.size(), 0);
  for (const Triangle& t : patch.triangles) {
    ++size[piece[t[0]]];
    for (const int v : t) {
      ends_at_side[piece[v]] |= iso.at_side[v];
      in_region[piece[v]] |= region.has(cell_of(lattice, iso.position[v]));
    }
  }
  Obstacles found;
  for (std::size_t v = 0; v < piece.size(); ++v)
    if (iso.at_side[v] && ends_at_side[piece[v]] && in_region[piece[v]]) found.push_back(iso.position[v]);
  if (!found.empty()) return found;
  const Boundary boundary = boundary_of(patch.triangles);
  for (const int v : boundary.pinched) open[piece[v]] = 1;
  for (const std::vector<int>& loop : boundary.loops) open[piece[loop[0]]] = 1;
  std::erase_if(patch.triangles, [&](const Triangle& t) {
    const int p = piece[t[0]];
    return ends_at_side[p] || (open[p] ? size[p] < kSmallestPiece : !in_region[p]);
  });
  return {};
}

}  // namespace

std::vector<Triangle> triangles_of(const TriangleMesh& mesh, std::span<const int> numbers) {
  std::vector<Triangle> result;
  result.reserve(numbers.size());
  for (const int t : numbers) result.push_back(mesh.triangles[t]);
  return result;
}

Hole hole_in(const TriangleMesh& mesh, const SampledField& lattice, const CellRegion& region,
             const CellRegion& around) {
  enum Place : char { outside, near, inside };
  std::vector<char> place(mesh.vertex_count());
  parallel_for(place.size(), [&](std::size_t v) {
    const LatticeCell cell = cell_of(lattice, mesh.position[v]);
    place[v] = region.has(cell) ? inside : around.has(cell) ? near : outside;
  });
  Hole hole;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (triangle == kRemovedTriangle) continue;
    const auto& [a, b, c] = triangle;
    const char innermost = std::max({place[a], place[b], place[c]});
    if (innermost == inside) hole.removed.push_back(t);
    if (innermost == near) hole.kept.push_back(t);
  }
  return hole;
}

Obstacles smooth_rim(const TriangleMesh& mesh, Hole& hole) {
  std::vector<int> pinched;
  for (int round = 0; round < kRimRounds; ++round) {
    const Boundary rim = boundary_of(triangles_of(mesh, hole.removed));
    pinched = rim.pinched;
    const std::vector<std::pair<int, int>> edges = edges_of(rim.loops);
    const auto moved = std::stable_partition(hole.kept.begin(), hole.kept.end(), [&](int t) {
      return !has_vertex(mesh.triangles[t], rim.pinched) && !has_edges_along(mesh.triangles[t], edges);
    });
    if (moved == hole.kept.end()) break;
    hole.removed.insert(hole.removed.end(), moved, hole.kept.end());
    hole.kept.erase(moved, hole.kept.end());
  }
  Obstacles found;
  for (const int v : pinched) found.push_back(mesh.position[v]);
  return found;
}

LatticeBlock block_around(const ReplacementSetting& setting, const TriangleMesh& mesh, const Hole& hole,
                          const CellRegion& region) {
  LatticeBlock block = region.block();
  const int padding =
      kSidePadding + static_cast<int>(std::ceil(kGap * setting.edge_length / setting.lattice.spacing));
  for (const int t : hole.removed)
    for (const int v : mesh.triangles[t]) {
      const LatticeCell cell = cell_of(setting.lattice, mesh.position[v]);
      for (int a = 0; a < 3; ++a) {
        block.first[a] = std::min(block.first[a], cell[a]);
        block.last[a] = std::max(block.last[a], cell[a] + 1);
      }
    }
  for (int a = 0; a < 3; ++a) {
    block.first[a] -= padding;
    block.last[a] += padding;
  }
  return block;
}

Obstacles make_patch(const ReplacementSetting& setting, const TriangleMesh& mesh, const Hole& hole,
                     const CellRegion& region, const LatticeBlock& block, int finer, Patch& patch) {
  SampledField lattice = setting.lattice;
  LatticeBlock fine = block;
  lattice.spacing /= finer;
  for (int a = 0; a < 3; ++a) {
    fine.first[a] *= finer;
    fine.last[a] *= finer;
  }
  patch.iso = local_isosurface(setting.field, lattice, fine, setting.tolerance);
  patch.triangles = away_from_kept(patch.iso, mesh, hole.kept, kGap * setting.edge_length);
  return drop_foreign_pieces(setting.lattice, region, patch);
}

bool leaves_surface(const ReplacementSetting& setting, const Patch& patch) {
  return parallel_max(patch.triangles.size(), 0, [&](std::size_t t) {
           return int{is_off_surface(setting.field, patch.iso.position, patch.iso.gradient,
                                     patch.triangles[t], setting.off_surface)};
         }) > 0;
}

void unpinch(std::vector<Triangle>& patch) {
  for (std::vector<int> pinched = boundary_of(patch).pinched; !pinched.empty();
       pinched = boundary_of(patch).pinched)
    std::erase_if(patch, [&](const Triangle& t) { return has_vertex(t, pinched); });
}

}  // namespace kappaflow
