#include "surface/topology/topology.h"

#include <algorithm>

#include "surface/mesh/isosurface.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/region_replacement.h"

namespace kappaflow {
namespace {

constexpr double kFarOff = 0.5, kOff = 0.18;  // distance of a triangle's centroid from f = 0, in edge lengths
constexpr double kDispute = 0.25;             // of a point of the lattice, in edge lengths
constexpr double kThread = 0.01;              // length of an edge around a thread, in edge lengths
constexpr int kCluster = 2;                   // cells of a region are in blocks of so many that touch
constexpr int kRegionGrowth = 1;              // of a region [cells], one more in each pass
constexpr int kPasses = 3;

/// Groups of cells whose blocks touch, each ascending; in the order of their first cells' blocks.
std::vector<std::vector<LatticeCell>> regions_of(const std::vector<LatticeCell>& cells) {
  const auto block_of = [](const LatticeCell& c) {
    LatticeCell block;
    for (int a = 0; a < 3; ++a) block[a] = (c[a] >= 0 ? c[a] : c[a] - kCluster + 1) / kCluster;
    return block;
  };
  std::vector<std::pair<LatticeCell, LatticeCell>> by_block;
  by_block.reserve(cells.size());
  for (const LatticeCell& c : cells) by_block.emplace_back(block_of(c), c);
  std::ranges::sort(by_block);
  by_block.erase(std::unique(by_block.begin(), by_block.end()), by_block.end());
  std::vector<char> taken(by_block.size(), 0);
  std::vector<std::vector<LatticeCell>> regions;
  std::vector<LatticeCell> pending;
  for (std::size_t seed = 0; seed < by_block.size(); ++seed) {
    if (taken[seed]) continue;
    std::vector<LatticeCell>& region = regions.emplace_back();
    pending.assign(1, by_block[seed].first);
    const auto take = [&](const LatticeCell& block) {
      auto entry = std::ranges::lower_bound(by_block, block, {}, [](const auto& e) { return e.first; }) -
                   by_block.begin();
      const auto end = static_cast<std::ptrdiff_t>(by_block.size());
      if (entry == end || by_block[entry].first != block || taken[entry]) return false;
      for (; entry < end && by_block[entry].first == block; ++entry) {
        taken[entry] = 1;
        region.push_back(by_block[entry].second);
      }
      return true;
    };
    take(pending[0]);
    while (!pending.empty()) {
      const LatticeCell at = pending.back();
      pending.pop_back();
      for (int n = 0; n < 27; ++n) {
        const LatticeCell next{at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1};
        if (take(next)) pending.push_back(next);
      }
    }
    std::ranges::sort(region);
  }
  return regions;
}

void add_cells(const SampledField& lattice, const TriangleMesh& mesh, std::span<const int> triangles,
               std::vector<LatticeCell>& cells) {
  for (const int t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &x = mesh.position[a], &y = mesh.position[b], &z = mesh.position[c];
    for (const Vec3& p : {x, y, z, Vec3((x + y + z) / 3)}) cells.push_back(cell_of(lattice, p));
  }
}

void finish(TriangleMesh& mesh, VertexFacts facts, VertexHistory& history) {
  std::vector<char> alive(mesh.vertex_count(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t) alive[v] = 1;
  remove_dead(alive, mesh, history);
  history.keep(facts.gradient);
  history.keep(facts.mobility);
}

/// Where the triangles are not pieces of the surface.
void add_cells_off_surface(const Field& field, const TriangleMesh& mesh, VertexFacts facts, double limit,
                           const SampledField& lattice, std::vector<LatticeCell>& cells) {
  add_cells(lattice, mesh, triangles_off_surface(field, mesh, facts.gradient, limit), cells);
}

/// Where edges are so short that remeshing would have collapsed them if it could: around a thread.
void add_cells_at_threads(const TriangleMesh& mesh, double shortest, const SampledField& lattice,
                          std::vector<LatticeCell>& cells) {
  for (const auto& [a, b, c] : mesh.triangles)
    for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      if (u < v && (mesh.position[u] - mesh.position[v]).squaredNorm() < shortest * shortest)
        cells.push_back(cell_of(lattice, mesh.position[u]));
}

/// Where the inside of the mesh is not the surface's, as the lattice in the blocks tells.
void add_cells_in_dispute(const Field& field, const TriangleMesh& mesh, double edge_length,
                          const SampledField& lattice, std::span<const LatticeBlock> blocks,
                          std::vector<LatticeCell>& cells) {
  for (const LatticeBlock& block : blocks) {
    const std::vector<LatticeCell> disputed =
        cells_in_dispute(field, mesh, kDispute * edge_length, lattice, block);
    cells.insert(cells.end(), disputed.begin(), disputed.end());
  }
}

/// All of the lattice's cells.
LatticeBlock whole(const SampledField& lattice) {
  return {{0, 0, 0}, {lattice.dims[0] - 1, lattice.dims[1] - 1, lattice.dims[2] - 1}};
}

/// The blocks, or the whole lattice where that has fewer rows.
std::vector<LatticeBlock> fewest_rows(std::vector<LatticeBlock> blocks, const SampledField& lattice) {
  const auto rows = [](const LatticeBlock& b) {
    return (b.last[1] - b.first[1] + 1.0) * (b.last[2] - b.first[2] + 1.0);
  };
  double sum = 0;
  for (const LatticeBlock& b : blocks) sum += rows(b);
  if (sum < rows(whole(lattice))) return blocks;
  return {whole(lattice)};
}

}  // namespace

SampledField topology_lattice(const Field& field, const TopologyOptions& options, double edge_length) {
  const double scale = field.length_scale();
  return isosurface_lattice(field, scale > 0 ? std::min(edge_length, options.spacing * scale) : edge_length);
}

LatticeGuard topology_guard(const Field& field, const TopologyOptions& options, double edge_length) {
  return {field, topology_lattice(field, options, edge_length), kDispute * edge_length};
}

TopologyCounts TopologyChange::change(const Field& field, const TopologyOptions& options, double edge_length,
                                      const ProjectionOptions& projection, Comparison comparison,
                                      TriangleMesh& mesh, VertexFacts facts) {
  const SampledField lattice = topology_lattice(field, options, edge_length);
  const ReplacementSetting setting{field,
                                   lattice,
                                   edge_length,
                                   projection.tolerance * field.length_scale(),
                                   kOff * edge_length,
                                   comparison == Comparison::repeated};
  RegionReplacement replacement(setting, mesh, facts);
  TopologyCounts& counts = replacement.counts;
  history_.vertices_at_start = static_cast<int>(mesh.vertex_count());
  std::vector<LatticeCell> cells;
  const double off_surface = (comparison == Comparison::quick ? kFarOff : kOff) * edge_length;
  add_cells_off_surface(field, mesh, facts, off_surface, lattice, cells);
  if (comparison != Comparison::quick) {
    add_cells(lattice, mesh, intersecting_triangles(mesh.position, mesh.triangles), cells);
    add_cells_at_threads(mesh, kThread * edge_length, lattice, cells);
    add_cells_in_dispute(field, mesh, edge_length, lattice, std::array{whole(lattice)}, cells);
  }
  for (int pass = 0; pass < kPasses && !cells.empty(); ++pass) {
    counts.refused = 0;
    replacement.replaced_blocks.clear();
    for (const std::vector<LatticeCell>& region : regions_of(cells))
      counts.refused += replacement.replace(region, kRegionGrowth + pass) ? 0 : 1;
    std::erase(mesh.triangles, kRemovedTriangle);
    cells.clear();
    add_cells_in_dispute(field, mesh, edge_length, lattice,
                         fewest_rows(std::move(replacement.replaced_blocks), lattice), cells);
  }
  if (counts.replaced == 0) return counts;
  finish(mesh, facts, history_);
  const auto first_born = std::ranges::lower_bound(history_.number, history_.vertices_at_start);
  counts.vertices_born = static_cast<std::size_t>(history_.number.end() - first_born);
  counts.vertices_lost = history_.vertices_at_start - (history_.number.size() - counts.vertices_born);
  return counts;
}

}  // namespace kappaflow
