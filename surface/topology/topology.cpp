#include "surface/topology/topology.h"

#include <algorithm>
#include <iterator>

#include "core/parallel.h"
#include "core/sort_unique.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
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

/// The triangles of which every corner is touched: all that have changed are among them.
std::vector<Triangle> touched_triangles(const TriangleMesh& mesh, std::span<const char> touched) {
  std::vector<Triangle> found;
  std::ranges::copy_if(mesh.triangles, std::back_inserter(found), [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](int v) { return touched[v] != 0; });
  });
  return found;
}

/// Where triangles in the blocks pass through each other.
void add_cells_of_crossings(const TriangleMesh& mesh, const SampledField& lattice,
                            std::span<const LatticeBlock> blocks, std::vector<LatticeCell>& cells) {
  std::vector<int> near;
  for (const std::vector<int>& of_block : triangles_near(lattice, mesh.position, mesh.triangles, blocks, 0))
    near.insert(near.end(), of_block.begin(), of_block.end());
  sort_unique(near);
  std::vector<Triangle> triangles;
  triangles.reserve(near.size());
  for (const int t : near) triangles.push_back(mesh.triangles[t]);
  std::vector<int> crossing = intersecting_triangles(mesh.position, triangles);
  for (int& t : crossing) t = near[t];
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

/// Where mesh and surface disagree, or the mesh passes through itself. blocks: where it is looked for.
std::vector<LatticeCell> disputed_cells(const ReplacementSetting& setting, bool quick,
                                        const TriangleMesh& mesh, std::span<const LatticeBlock> blocks) {
  const auto& [field, lattice, edge_length, tolerance, off_surface, seam_off_surface, may_be_finer] = setting;
  std::vector<LatticeCell> cells;
  add_cells_off_surface(field, mesh, quick ? kFarOff * edge_length : off_surface, lattice, cells);
  if (quick) return cells;
  add_cells_of_crossings(mesh, lattice, blocks, cells);
  add_cells_at_threads(mesh, kThread * edge_length, lattice, cells);
  std::ranges::copy(cells_in_dispute(field, mesh, kDispute * edge_length, lattice, blocks),
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

std::vector<LatticeBlock> TopologyChange::to_compare(const Field& field, const TriangleMesh& mesh,
                                                     const SampledField& lattice, Comparison comparison,
                                                     std::span<const char> touched) const {
  if (comparison == Comparison::quick) return {};
  if (comparison == Comparison::thorough) return everywhere(field, mesh, lattice);
  auto blocks = blocks_of(lattice, cubes_of(lattice, mesh.position, touched_triangles(mesh, touched)));
  blocks.insert(blocks.end(), unsettled_.begin(), unsettled_.end());
  return or_everywhere(field, mesh, lattice, std::move(blocks));
}

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
  const auto blocks = to_compare(field, mesh, lattice, comparison, touched);
  unsettled_.clear();
  TopologyCounts counts;
  std::vector<LatticeCell> cells = disputed_cells(setting, comparison == Comparison::quick, mesh, blocks);
  if (cells.empty()) return counts;
  edits_.start(mesh);
  VertexCells vertices(lattice);
  Replaced replaced;
  for (int pass = 0; pass < kPasses && !cells.empty(); ++pass) {
    replaced.blocks.clear();
    replace_regions(setting, regions_of(cells), kRegionGrowth + pass, edits_, vertices, replaced);
    edits_.drop_removed_triangles();
    unsettled_.insert(unsettled_.end(), replaced.blocks.begin(), replaced.blocks.end());
    cells = cells_in_dispute(field, mesh, kDispute * edge_length, lattice,
                             or_everywhere(field, mesh, lattice, std::move(replaced.blocks)));
  }
  unsettled_.insert(unsettled_.end(), replaced.refused.begin(), replaced.refused.end());
  for (const LatticeCell& cell : cells) unsettled_.push_back({cell, cell});
  edits_.finish();
  counts.replaced = replaced.regions;
  counts.refused = replaced.refused.size();
  counts.triangles_removed = replaced.triangles_removed;
  if (counts.replaced > 0) count_vertices(edits_.history(), counts);
  return counts;
}

}  // namespace kappaflow
