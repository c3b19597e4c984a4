#include "surface/topology/region_replacement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/nearest_on_triangle.h"
#include "core/parallel.h"
#include "core/triangle_tree.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/loops.h"
#include "surface/topology/triangle_bins.h"

namespace kappaflow {
namespace {

constexpr double kGap = 0.25;        // between the mesh and the patch, in edge lengths
constexpr double kSameSide = 0.2;    // least cosine between normals of one sheet
constexpr double kSurroundings = 4;  // reach of the triangles that a replacement looks at, in edge lengths
constexpr int kFiner = 2;        // cells of a patch's lattice along one of the other lattice's, to begin with
constexpr int kSidePadding = 2;  // cells between all that matters and the block's sides
constexpr int kRimRounds = 20;   // of smoothing the rim
constexpr int kAttempts = 12;    // at a region, each wider than the one before
constexpr std::size_t kSmallestPiece = 3;  // triangles of a patch that is worth sewing in
constexpr std::size_t kLongestFill = 80;   // corners of a loop that is filled

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

/// How many of the triangle's edges run against one of the sorted edges.
int edges_along(const Triangle& t, std::span<const std::pair<int, int>> edges) {
  int along = 0;
  for (int c = 0; c < 3; ++c) along += std::ranges::binary_search(edges, std::pair(t[(c + 1) % 3], t[c]));
  return along;
}

/// The connected piece of each vertex, as its smallest vertex.
std::vector<int> pieces_of(std::size_t vertices, std::span<const Triangle> triangles) {
  std::vector<int> parent(vertices);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b, c] : triangles)
    for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c)}) {
      const int p = root(u), q = root(v);
      parent[std::max(p, q)] = std::min(p, q);
    }
  for (int v = 0; v < static_cast<int>(vertices); ++v) parent[v] = root(v);
  return parent;
}

}  // namespace

bool RegionReplacement::replace(std::span<const LatticeCell> cells, int growth) {
  std::vector<LatticeCell> wider(cells.begin(), cells.end());
  const int surroundings =
      static_cast<int>(std::ceil(kSurroundings * setting_.edge_length / setting_.lattice.spacing));
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const CellRegion region(wider, growth);
    const CellRegion around(wider, growth + surroundings);
    if (around.too_large()) return false;
    in_the_way_.clear();
    if (replace(region, around)) return true;
    if (std::ranges::all_of(in_the_way_, [&](const LatticeCell& c) { return region.has(c); })) ++growth;
    wider.insert(wider.end(), in_the_way_.begin(), in_the_way_.end());
  }
  return false;
}

bool RegionReplacement::replace(const CellRegion& region, const CellRegion& around) {
  take_out(region, around);
  if (!smooth_rim()) return false;
  const LatticeBlock block = block_around(region);
  LocalIsosurface iso;
  if (!make_patch(block, kFiner, region, iso)) return false;
  if (setting_.may_be_finer && patch_leaves_surface(iso) && !make_patch(block, 2 * kFiner, region, iso))
    return false;
  unpinch_patch();
  if (removed_.empty() && patch_.empty()) return true;  // an earlier replacement has settled it
  append_vertices(iso);
  const bool sound = sew() && is_sound();
  if (sound)
    commit(block);
  else
    roll_back();
  return sound;
}

/// Sorts the triangles into those with a corner in the region and those around that stay.
void RegionReplacement::take_out(const CellRegion& region, const CellRegion& around) {
  enum Place : char { outside, near, inside };
  std::vector<char> place(mesh_.vertex_count());
  parallel_for(place.size(), [&](std::size_t v) {
    const LatticeCell cell = cell_of(setting_.lattice, mesh_.position[v]);
    place[v] = region.has(cell) ? inside : around.has(cell) ? near : outside;
  });
  removed_.clear();
  kept_.clear();
  for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
    const Triangle& triangle = mesh_.triangles[t];
    if (triangle == kRemovedTriangle) continue;
    const auto& [a, b, c] = triangle;
    const char innermost = std::max({place[a], place[b], place[c]});
    if (innermost == inside) removed_.push_back(t);
    if (innermost == near) kept_.push_back(t);
  }
}

std::vector<Triangle> RegionReplacement::triangles(std::span<const int> numbers) const {
  std::vector<Triangle> result;
  result.reserve(numbers.size());
  for (const int t : numbers) result.push_back(mesh_.triangles[t]);
  return result;
}

/// Takes more out until no vertex joins two loops of the hole's rim, and no triangle juts out into it.
bool RegionReplacement::smooth_rim() {
  std::vector<int> pinched;
  for (int round = 0; round < kRimRounds; ++round) {
    const Boundary rim = boundary_of(triangles(removed_));
    pinched = rim.pinched;
    const std::vector<std::pair<int, int>> edges = edges_of(rim.loops);
    const auto moved = std::stable_partition(kept_.begin(), kept_.end(), [&](int t) {
      return !has_vertex(mesh_.triangles[t], rim.pinched) && edges_along(mesh_.triangles[t], edges) < 2;
    });
    if (moved == kept_.end()) break;
    removed_.insert(removed_.end(), moved, kept_.end());
    kept_.erase(moved, kept_.end());
  }
  blame(pinched);
  return pinched.empty();
}

/// All that the patch may consist of, and some cells more.
LatticeBlock RegionReplacement::block_around(const CellRegion& region) const {
  LatticeBlock block = region.block();
  const int padding =
      kSidePadding + static_cast<int>(std::ceil(kGap * setting_.edge_length / setting_.lattice.spacing));
  for (const int t : removed_)
    for (const int v : mesh_.triangles[t]) {
      const LatticeCell cell = cell_of(setting_.lattice, mesh_.position[v]);
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

/// Cuts the patch out of the isosurface on a lattice that is finer by a whole number. Its points are the
/// lattice's and others between them: what agrees with one agrees with the other.
bool RegionReplacement::make_patch(const LatticeBlock& block, int finer, const CellRegion& region,
                                   LocalIsosurface& iso) {
  SampledField lattice = setting_.lattice;
  LatticeBlock fine = block;
  lattice.spacing /= finer;
  for (int a = 0; a < 3; ++a) {
    fine.first[a] *= finer;
    fine.last[a] *= finer;
  }
  iso = local_isosurface(setting_.field, lattice, fine, setting_.tolerance);
  cut_near_kept(iso);
  return drop_foreign_pieces(iso, region);
}

/// Whether a chord of the patch misses a rim or tip.
bool RegionReplacement::patch_leaves_surface(const LocalIsosurface& iso) const {
  return parallel_max(patch_.size(), 0, [&](std::size_t t) {
           return int{
               is_off_surface(setting_.field, iso.position, iso.gradient, patch_[t], setting_.off_surface)};
         }) > 0;
}

/// The patch is what of the isosurface keeps a distance from the mesh that stays.
void RegionReplacement::cut_near_kept(const LocalIsosurface& iso) {
  const double gap = kGap * setting_.edge_length;
  const TriangleBins bins(mesh_, kept_, gap);
  std::vector<char> near(iso.position.size());
  parallel_for(near.size(), [&](std::size_t v) {
    const Vec3 normal = -iso.gradient[v].normalized();
    near[v] = bins.any_near(iso.position[v], [&](int t) {
      const std::array<Vec3, 3> at = corners(mesh_.triangles[t]);
      return (nearest_on_triangle(at, iso.position[v]).point - iso.position[v]).norm() <= gap &&
             (at[1] - at[0]).cross(at[2] - at[0]).normalized().dot(normal) > kSameSide;
    });
  });
  patch_.clear();
  for (const Triangle& t : iso.triangles)
    if (std::ranges::none_of(t, [&](int v) { return near[v]; })) patch_.push_back(t);
}

/// Pieces of the patch that end at the block's side belong to another region, unless they reach into this
/// one: then the block is too small. So do closed ones outside; and specks go.
bool RegionReplacement::drop_foreign_pieces(const LocalIsosurface& iso, const CellRegion& region) {
  const std::vector<int> piece = pieces_of(iso.position.size(), patch_);
  std::vector<char> ends_at_side(piece.size(), 0), in_region(piece.size(), 0), open(piece.size(), 0);
  std::vector<std::size_t> size(piece.size(), 0);
  for (const Triangle& t : patch_) {
    ++size[piece[t[0]]];
    for (const int v : t) {
      ends_at_side[piece[v]] |= iso.at_side[v];
      in_region[piece[v]] |= region.has(cell_of(setting_.lattice, iso.position[v]));
    }
  }
  for (std::size_t v = 0; v < piece.size(); ++v)
    if (iso.at_side[v] && ends_at_side[piece[v]] && in_region[piece[v]]) blame(iso.position[v]);
  if (!in_the_way_.empty()) return false;
  const Boundary boundary = boundary_of(patch_);
  for (const int v : boundary.pinched) open[piece[v]] = 1;
  for (const std::vector<int>& loop : boundary.loops) open[piece[loop[0]]] = 1;
  std::erase_if(patch_, [&](const Triangle& t) {
    const int p = piece[t[0]];
    return ends_at_side[p] || (open[p] ? size[p] < kSmallestPiece : !in_region[p]);
  });
  return true;
}

void RegionReplacement::unpinch_patch() {
  for (std::vector<int> pinched = boundary_of(patch_).pinched; !pinched.empty();
       pinched = boundary_of(patch_).pinched)
    std::erase_if(patch_, [&](const Triangle& t) { return has_vertex(t, pinched); });
}

/// Position and gradient of the patch's vertices, from here on by their numbers in the mesh.
void RegionReplacement::append_vertices(const LocalIsosurface& iso) {
  first_new_ = mesh_.vertex_count();
  exact_.clear();
  std::vector<int> number(iso.position.size(), -1);
  for (Triangle& t : patch_)
    for (int& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(mesh_.position.size());
        mesh_.position.push_back(iso.position[v]);
        facts_.gradient.push_back(iso.gradient[v]);
        exact_.push_back(iso.exact[v]);
      }
      v = number[v];
    }
}

/// Joins every loop of the patch with one of the hole, and fills those that are left.
bool RegionReplacement::sew() {
  seams_.clear();
  const std::vector<std::vector<int>> holes = boundary_of(triangles(removed_)).loops,
                                      loops = boundary_of(patch_).loops;
  std::vector<int> loop_at(holes.size(), -1);
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const int hole = matching_hole(loops[l], holes);
    if (hole < 0) {
      blame(loops[l]);
      return false;
    }
    int& taken = loop_at[hole];
    if (taken < 0) {
      taken = static_cast<int>(l);
      continue;
    }
    const bool larger = loops[l].size() > loops[taken].size();
    if (!drop_island(loops, larger ? taken : l)) {
      blame(holes[hole]);
      return false;
    }
    if (larger) taken = static_cast<int>(l);
  }
  for (std::size_t h = 0; h < holes.size(); ++h) {
    if (loop_at[h] < 0 && holes[h].size() > kLongestFill) {
      blame(holes[h]);
      return false;
    }
    const std::vector<Triangle> seam =
        loop_at[h] < 0 ? fill_loop(mesh_.position, facts_.gradient, holes[h])
                       : strip_between(mesh_.position, facts_.gradient, holes[h], loops[loop_at[h]]);
    seams_.insert(seams_.end(), seam.begin(), seam.end());
  }
  return true;
}

/// The hole to which most of the loop's vertices are nearest, on the same side of the liquid; -1 without any.
int RegionReplacement::matching_hole(std::span<const int> loop,
                                     std::span<const std::vector<int>> holes) const {
  std::vector<int> votes(holes.size(), 0);
  for (const int v : loop) {
    double least = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (std::size_t h = 0; h < holes.size(); ++h)
      for (const int w : holes[h]) {
        const double distance = (mesh_.position[w] - mesh_.position[v]).squaredNorm();
        if (!(distance < least) || !(facts_.gradient[w].dot(facts_.gradient[v]) > 0)) continue;
        least = distance;
        nearest = static_cast<int>(h);
      }
    if (nearest >= 0) ++votes[nearest];
  }
  const auto most = std::ranges::max_element(votes);
  return most == votes.end() || *most == 0 ? -1 : static_cast<int>(most - votes.begin());
}

/// Takes a piece of the patch with no other loop than this one away.
bool RegionReplacement::drop_island(std::span<const std::vector<int>> loops, std::size_t loop) {
  const std::vector<int> piece = pieces_of(mesh_.vertex_count(), patch_);
  const int island = piece[loops[loop][0]];
  if (std::ranges::count_if(loops, [&](const auto& l) { return piece[l[0]] == island; }) > 1) return false;
  std::erase_if(patch_, [&](const Triangle& t) { return piece[t[0]] == island; });
  return true;
}

/// Whether the seams are on the surface, and with the patch pass through nothing and have three neighbours.
bool RegionReplacement::is_sound() {
  for (const Triangle& t : seams_)
    if (is_off_surface(setting_.field, mesh_.position, facts_.gradient, t, setting_.off_surface)) blame(t);
  if (!in_the_way_.empty()) return false;
  std::vector<Triangle> all = triangles(kept_);
  const std::size_t kept = all.size();
  all.insert(all.end(), patch_.begin(), patch_.end());
  all.insert(all.end(), seams_.begin(), seams_.end());
  std::vector<std::pair<int, int>> edges;
  for (const Triangle& t : all)
    for (int c = 0; c < 3; ++c) edges.emplace_back(t[c], t[(c + 1) % 3]);
  std::ranges::sort(edges);
  const auto once = [&](int u, int v) {
    const auto [first, last] = std::equal_range(edges.begin(), edges.end(), std::pair(u, v));
    return last - first == 1;
  };
  for (std::size_t t = kept; t < all.size(); ++t)
    for (int c = 0; c < 3; ++c)
      if (!once(all[t][c], all[t][(c + 1) % 3]) || !once(all[t][(c + 1) % 3], all[t][c])) blame(all[t]);
  if (!in_the_way_.empty()) return false;
  const std::vector<int> crossing = intersecting_triangles(mesh_.position, all);
  if (crossing.empty() || crossing.back() < static_cast<int>(kept)) return true;
  for (const int t : crossing) blame(all[t]);
  return false;
}

/// Has the next attempt reach beyond these vertices.
void RegionReplacement::blame(std::span<const int> vertices) {
  for (const int v : vertices) blame(mesh_.position[v]);
}

void RegionReplacement::blame(const Vec3& x) {
  in_the_way_.push_back(cell_of(setting_.lattice, x));
}

void RegionReplacement::commit(const LatticeBlock& block) {
  const std::size_t born = mesh_.position.size() - first_new_;
  const std::vector<VertexBlend> source = sources();
  for (std::size_t i = 0; i < born; ++i) {
    const Vec3& x = mesh_.position[first_new_ + i];
    mesh_.rest_position.push_back(source.empty() ? x : blended(mesh_.rest_position, source[i]));
    mesh_.source.push_back(source.empty() ? kUnknownSource : mesh_.source[heaviest(source[i])]);
    facts_.mobility.push_back(source.empty() ? 1 : blended(facts_.mobility, source[i]));
    mesh_.unprojected.push_back(!exact_[i]);
    mesh_.id.push_back(mesh_.next_id++);
  }
  for (const int t : removed_) mesh_.triangles[t] = kRemovedTriangle;
  mesh_.triangles.insert(mesh_.triangles.end(), patch_.begin(), patch_.end());
  mesh_.triangles.insert(mesh_.triangles.end(), seams_.begin(), seams_.end());
  replaced_blocks.push_back(block);
  ++counts.replaced;
  counts.triangles_removed += removed_.size();
}

void RegionReplacement::roll_back() {
  mesh_.position.resize(first_new_);
  facts_.gradient.resize(first_new_);
}

/// Of each new vertex the nearest point of the triangles taken out; none where there were none.
std::vector<VertexBlend> RegionReplacement::sources() const {
  if (removed_.empty()) return {};
  std::vector<TriangleTree::Corners> taken_out;
  taken_out.reserve(removed_.size());
  for (const int t : removed_) taken_out.push_back(corners(mesh_.triangles[t]));
  const TriangleTree tree(taken_out);
  std::vector<VertexBlend> source(mesh_.position.size() - first_new_);
  parallel_for(source.size(), [&](std::size_t i) {
    const auto nearest = tree.nearest(mesh_.position[first_new_ + i]);
    const Triangle& triangle = mesh_.triangles[removed_[nearest.triangle]];
    const Vec3 weight = corner_weights(corners(triangle), nearest.at.point);
    source[i] = {triangle, {weight[0], weight[1], weight[2]}};
  });
  return source;
}

}  // namespace kappaflow
