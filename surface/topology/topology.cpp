#include "surface/topology/topology.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "core/sort_unique.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/patch.h"
#include "surface/topology/region_replacement.h"

namespace kappaflow {
namespace {

constexpr double kFarOff = 0.5, kOff = 0.18;  // distance of a triangle's centroid from f = 0, in edge lengths
constexpr double kSeamOff = 0.3;              // the same of seams between frames
constexpr double kDispute = 0.25;             // of a point of the lattice, in edge lengths
constexpr double kFewPoints =
    1e6;  // of a lattice, that are compared before it is known where else there is surface
constexpr double kThread = 0.01;  // length of an edge around a thread, in edge lengths
constexpr int kCluster = 2;       // cells of a region are in blocks of so many that touch
constexpr int kRegionGrowth = 1;  // of a region [cells], one more in each pass
constexpr int kPasses = 3;
constexpr int kUnsettled = 8;     // [cells] along the cubes in which is kept what was left as it was
constexpr double kEditReach = 2;  // of an edit beyond the triangles that come of it, in edge lengths

/// Cells by the blocks of kCluster^3 that they lie in, ascending.
std::vector<std::pair<LatticeCell, LatticeCell>> cells_by_block(std::span<const LatticeCell> cells) {
  std::vector<std::pair<LatticeCell, LatticeCell>> by_block;
  by_block.reserve(cells.size());
  for (const LatticeCell& c : cells) by_block.emplace_back(coarser(c, kCluster), c);
  sort_unique(by_block);
  return by_block;
}

/// Takes the cells of a block that have not been taken yet into the region. Returns whether there were any.
bool take_block(const LatticeCell& block, std::span<const std::pair<LatticeCell, LatticeCell>> by_block,
                std::vector<char>& taken, std::vector<LatticeCell>& region) {
  const auto first = std::ranges::lower_bound(by_block, block, {}, [](const auto& e) { return e.first; });
  bool found = false;
  for (auto e = first; e != by_block.end() && e->first == block; ++e) {
    if (taken[e - by_block.begin()]) return false;
    taken[e - by_block.begin()] = 1;
    region.push_back(e->second);
    found = true;
  }
  return found;
}

/// Groups of cells whose blocks touch, each ascending; in the order of their first cells' blocks.
std::vector<std::vector<LatticeCell>> regions_of(std::span<const LatticeCell> cells) {
  const auto by_block = cells_by_block(cells);
  std::vector<char> taken(by_block.size(), 0);
  std::vector<std::vector<LatticeCell>> regions;
  for (std::size_t seed = 0; seed < by_block.size(); ++seed) {
    if (taken[seed]) continue;
    std::vector<LatticeCell>& region = regions.emplace_back();
    std::vector<LatticeCell> pending{by_block[seed].first};
    take_block(pending[0], by_block, taken, region);
    while (!pending.empty()) {
      const LatticeCell at = pending.back();
      pending.pop_back();
      for (int n = 0; n < 27; ++n) {
        const LatticeCell next{at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
        if (take_block(next, by_block, taken, region)) pending.push_back(next);
      }
    }
    std::ranges::sort(region);
  }
  return regions;
}

/// Where the triangles are not pieces of the surface.
void add_cells_off_surface(const Field& field, const TriangleMesh& mesh, double limit,
                           const SampledField& lattice, std::vector<LatticeCell>& cells) {
  std::ranges::copy(cells_of(lattice, mesh, triangles_off_surface(field, mesh, limit)),
                    std::back_inserter(cells));
}

/// Where edges are so short that remeshing would have collapsed them if it could: around a thread.
void add_cells_at_threads(const TriangleMesh& mesh, double shortest, const SampledField& lattice,
                          std::vector<LatticeCell>& cells) {
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (u < v && (mesh.position[u] - mesh.position[v]).squaredNorm() < shortest * shortest)
        cells.push_back(cell_of(lattice, mesh.position[u]));
}

/// Where there is surface or mesh.
std::vector<LatticeBlock> everywhere(const Field& field, const TriangleMesh& mesh,
                                     const SampledField& lattice) {
  return occupied_blocks(field, lattice, cubes_of(lattice, mesh.position, mesh.triangles));
}

/// The given blocks or, if that is less, where there is surface or mesh.
std::vector<LatticeBlock> or_everywhere(const Field& field, const TriangleMesh& mesh,
                                        const SampledField& lattice, std::vector<LatticeBlock> blocks) {
  const double points = points_in(blocks);
  if (points <= kFewPoints) return blocks;
  std::vector<LatticeBlock> all = everywhere(field, mesh, lattice);
  return points_in(all) < points ? all : blocks;
}

/// Where the changed triangles, by number, pass through others or each other.
void add_cells_of_crossings(const TriangleMesh& mesh, const SampledField& lattice,
                            std::span<const int> changed, std::vector<LatticeCell>& cells) {
  std::vector<int> order;  // the others go first
  order.reserve(mesh.triangles.size());
  auto next = changed.begin();
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (next != changed.end() && *next == t)
      ++next;
    else
      order.push_back(t);
  const std::size_t known = order.size();
  order.insert(order.end(), changed.begin(), changed.end());
  std::vector<int> crossing = intersecting_triangles(mesh.position, triangles_of(mesh, order), known);
  for (int& t : crossing) t = order[t];
  std::ranges::copy(cells_of(lattice, mesh, crossing), std::back_inserter(cells));
}

}  // namespace

SampledField topology_lattice(const Field& field, const TopologyOptions& options, double edge_length) {
  const double scale = field.length_scale();
  return isosurface_lattice(field, scale > 0 ? std::min(edge_length, options.spacing * scale) : edge_length);
}

LatticeGuard topology_guard(const Field& field, const TopologyOptions& options, double edge_length) {
  return {field, topology_lattice(field, options, edge_length), kDispute * edge_length};
}

namespace {

/// What a comparison of mesh and surface looks at, beside what every one does.
struct Scope {
  std::vector<int> triangles;        // that may pass through others
  std::vector<LatticeBlock> blocks;  // in which points may be in dispute
};

Scope whole_scope(const Field& field, const TriangleMesh& mesh, const SampledField& lattice) {
  Scope scope{std::vector<int>(mesh.triangles.size()), everywhere(field, mesh, lattice)};
  std::iota(scope.triangles.begin(), scope.triangles.end(), 0);
  return scope;
}

/// The cells of a lattice kUnsettled times as coarse that hold the boxes or the cells, ascending.
std::vector<LatticeCell> coarse_cells(std::span<const LatticeBlock> boxes,
                                      std::span<const LatticeCell> cells) {
  std::vector<LatticeCell> coarse;
  for (const LatticeBlock& box : boxes) {
    const LatticeCell first = coarser(box.first, kUnsettled), last = coarser(box.last, kUnsettled);
    LatticeCell at;
    for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
        for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) coarse.push_back(at);
  }
  for (const LatticeCell& cell : cells) coarse.push_back(coarser(cell, kUnsettled));
  sort_unique(coarse);
  return coarse;
}

LatticeBlock points_of(const LatticeCell& coarse) {
  LatticeBlock block;
  for (int a = 0; a < 3; ++a) {
    block.first[a] = coarse[a] * kUnsettled;
    block.last[a] = block.first[a] + kUnsettled;
  }
  return block;
}

/// Where something may have changed, all corners being touched, or is unsettled: in coarse cells.
Scope scope_of(const Field& field, const TriangleMesh& mesh, const SampledField& lattice, double edge_length,
               std::span<const char> touched, std::span<const LatticeCell> unsettled) {
  const auto is_unsettled = [&](int v) {
    return !unsettled.empty() &&
           std::ranges::binary_search(unsettled, coarser(cell_of(lattice, mesh.position[v]), kUnsettled));
  };
  Scope scope;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (const Triangle& corners = mesh.triangles[t];
        std::ranges::all_of(corners, [&](int v) { return touched[v] != 0; }) ||
        std::ranges::any_of(corners, is_unsettled))
      scope.triangles.push_back(t);
  // What was there before an edit may have been further away than what is there now.
  std::vector<LatticeBlock> blocks =
      blocks_of(lattice, cubes_of(lattice, mesh.position, triangles_of(mesh, scope.triangles),
                                  kEditReach * edge_length / lattice.spacing));
  std::ranges::transform(unsettled, std::back_inserter(blocks), points_of);
  scope.blocks = or_everywhere(field, mesh, lattice, std::move(blocks));
  return scope;
}

/// Where mesh and surface disagree, or the mesh passes through itself.
std::vector<LatticeCell> disputed_cells(const ReplacementSetting& setting, bool quick,
                                        const TriangleMesh& mesh, const Scope& scope) {
  const auto& [field, lattice, edge_length, tolerance, off_surface, seam_off_surface, may_be_finer] = setting;
  std::vector<LatticeCell> cells;
  add_cells_off_surface(field, mesh, quick ? kFarOff * edge_length : off_surface, lattice, cells);
  if (quick) return cells;
  add_cells_of_crossings(mesh, lattice, scope.triangles, cells);
  add_cells_at_threads(mesh, kThread * edge_length, lattice, cells);
  std::ranges::copy(cells_in_dispute(field, mesh, kDispute * edge_length, lattice, scope.blocks),
                    std::back_inserter(cells));
  return cells;
}

/// Vertices that are new, and those that are gone.
void count_vertices(const VertexHistory& history, TopologyCounts& counts) {
  const auto first_born = std::ranges::lower_bound(history.number, history.vertices_at_start);
  counts.vertices_born = static_cast<std::size_t>(history.number.end() - first_born);
  counts.vertices_lost = history.vertices_at_start - (history.number.size() - counts.vertices_born);
}

}  // namespace

TopologyCounts TopologyChange::change(const Field& field, const TopologyOptions& options, double edge_length,
                                      const ProjectionOptions& projection, Comparison comparison,
                                      TriangleMesh& mesh, std::span<const char> touched) {
  const SampledField lattice = topology_lattice(field, options, edge_length);
  const ReplacementSetting setting{field,
                                   lattice,
                                   edge_length,
                                   projection.tolerance * field.length_scale(),
                                   kOff * edge_length,
                                   (comparison == Comparison::quick ? kSeamOff : kOff) * edge_length,
                                   comparison == Comparison::repeated};
  Scope scope;
  if (comparison != Comparison::quick)
    scope = touched.empty() ? whole_scope(field, mesh, lattice)
                            : scope_of(field, mesh, lattice, edge_length, touched, unsettled_);
  unsettled_.clear();
  TopologyCounts counts;
  std::vector<LatticeCell> cells = disputed_cells(setting, comparison == Comparison::quick, mesh, scope);
  if (cells.empty()) return counts;
  edits_.start(mesh);
  VertexCells vertices(lattice);
  Replaced replaced;
  for (int pass = 0; pass < kPasses && !cells.empty(); ++pass) {
    replaced.blocks.clear();
    replace_regions(setting, regions_of(cells), kRegionGrowth + pass, edits_, vertices, replaced);
    edits_.drop_removed_triangles();
    cells = cells_in_dispute(field, mesh, kDispute * edge_length, lattice,
                             or_everywhere(field, mesh, lattice, std::move(replaced.blocks)));
  }
  unsettled_ = coarse_cells(replaced.failed, cells);
  edits_.finish();
  counts.replaced = replaced.regions;
  counts.refused = replaced.refused.size();
  counts.triangles_removed = replaced.triangles_removed;
  if (counts.replaced > 0) count_vertices(edits_.history(), counts);
  return counts;
}

}  // namespace kappaflow
