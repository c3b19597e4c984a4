#include "surface/topology/patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/connectivity.h"
#include "core/nearest_on_triangle.h"
#include "core/parallel.h"
#include "core/split_mix.h"
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

/// Numbers that some vertices of a large mesh get, by a hash table with linear probing.
class VertexNumbers {
 public:
  /// The vertex's number, or -1.
  int find(int vertex) const { return table_[slot(vertex)].number; }
  void set(int vertex, int number) {
    if (2 * (size_ + 1) > table_.size()) grow();
    Entry& entry = table_[slot(vertex)];
    size_ += entry.vertex < 0;
    entry = {vertex, number};
  }

 private:
  struct Entry {
    int vertex = -1, number = -1;
  };

  /// Where the vertex is, or the empty place where it belongs.
  std::size_t slot(int vertex) const {
    std::size_t at = split_mix(static_cast<std::uint64_t>(vertex));
    while (table_[at &= table_.size() - 1].vertex >= 0 && table_[at].vertex != vertex) ++at;
    return at;
  }
  void grow() {
    std::vector<Entry> before(2 * table_.size());
    std::swap(before, table_);
    for (const Entry& entry : before)
      if (entry.vertex >= 0) table_[slot(entry.vertex)] = entry;
  }

  std::vector<Entry> table_{1024};
  std::size_t size_ = 0;
};

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
  int along = 0;
  for (int c = 0; c < 3; ++c) along += std::ranges::binary_search(edges, std::pair(t[(c + 1) % 3], t[c]));
  return along >= 2;
}

/// By vertex, how it takes part in a boundary.
enum class OnRim : char { no, once, pinched };
std::vector<OnRim> on_rim(std::size_t vertices, const Boundary& rim) {
  std::vector<OnRim> result(vertices, OnRim::no);
  for (const std::vector<int>& loop : rim.loops)
    for (const int v : loop) result[v] = OnRim::once;
  for (const int v : rim.pinched) result[v] = OnRim::pinched;
  return result;
}

/// The triangles that stay: the patch is what of f = 0 keeps a distance from them.
class KeptTriangles {
 public:
  KeptTriangles(const TriangleMesh& mesh, std::span<const int> kept, double gap)
      : mesh_(mesh), gap_(gap), box_(mesh.triangles.size()), bins_(mesh, kept, gap) {
    for (const int t : kept) {
      const auto [a, b, c] = corners(t);
      box_[t] = {a.cwiseMin(b).cwiseMin(c).array() - gap, a.cwiseMax(b).cwiseMax(c).array() + gap};
    }
  }

  /// Whether one is within the gap of a point of f = 0 with this gradient, on the same side of the liquid.
  bool is_near(const Vec3& x, const Vec3& gradient) const {
    const Vec3 normal = -gradient.normalized();
    return bins_.any_near(x, [&](int t) {
      if (!((x.array() >= box_[t].lower.array()).all() && (x.array() <= box_[t].upper.array()).all()))
        return false;
      const std::array<Vec3, 3> at = corners(t);
      return (nearest_on_triangle(at, x).point - x).norm() <= gap_ &&
             twice_area_vector(at[0], at[1], at[2]).normalized().dot(normal) > kSameSide;
    });
  }

 private:
  struct Box {
    Vec3 lower, upper;
  };
  std::array<Vec3, 3> corners(int t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return {mesh_.position[a], mesh_.position[b], mesh_.position[c]};
  }

  const TriangleMesh& mesh_;
  double gap_;
  std::vector<Box> box_;
  TriangleBins bins_;
};

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

/// Appends the cells of the finer lattice in those of the region.
void add_finer_cells(const CellRegion& region, int finer, std::vector<LatticeCell>& cells) {
  const auto [first, last] = region.block();
  LatticeCell at;
  for (at[2] = first[2] * finer; at[2] < last[2] * finer; ++at[2])
    for (at[1] = first[1] * finer; at[1] < last[1] * finer; ++at[1])
      for (at[0] = first[0] * finer; at[0] < last[0] * finer; ++at[0])
        if (region.has(coarser(at, finer))) cells.push_back(at);
}

/// Where a patch is looked for: in the region, and near all that is taken out.
std::vector<LatticeCell> seeds_of(const SampledField& lattice, const TriangleMesh& mesh, const Hole& hole,
                                  const CellRegion& region, int finer) {
  std::vector<LatticeCell> seeds;
  add_finer_cells(region, finer, seeds);
  if (!hole.removed.empty())
    add_finer_cells(CellRegion(cells_of(lattice, mesh, hole.removed), 1), finer, seeds);
  return seeds;
}

}  // namespace

std::vector<Triangle> triangles_of(const TriangleMesh& mesh, std::span<const int> numbers) {
  std::vector<Triangle> result;
  result.reserve(numbers.size());
  for (const int t : numbers) result.push_back(mesh.triangles[t]);
  return result;
}

Surroundings surroundings_of(const MeshEdits& edits, const VertexCells& vertices, const SampledField& lattice,
                             const CellRegion& around) {
  const TriangleMesh& mesh = edits.mesh();
  Surroundings near;
  VertexNumbers number;
  const auto enter = [&](int v) {
    if (number.find(v) >= 0) return;
    number.set(v, static_cast<int>(near.vertex.size()));
    near.vertex.push_back(v);
  };
  vertices.for_each_in(around.block(), [&](int v) {
    if (edits.is_alive(v) && around.has(cell_of(lattice, mesh.position[v]))) enter(v);
  });
  const int inside = static_cast<int>(near.vertex.size());
  const auto is_first = [&](int v, const Triangle& t) {  // of the triangle's corners inside
    return std::ranges::none_of(t, [&](int w) { return w < v && number.find(w) >= 0; });
  };
  for (int i = 0; i < inside; ++i)
    edits.for_each_out(near.vertex[i], [&](int h) {
      if (is_first(near.vertex[i], mesh.triangles[h / 3])) near.triangle.push_back(h / 3);
    });
  std::ranges::sort(near.triangle);
  for (const int t : near.triangle)
    for (const int v : mesh.triangles[t]) enter(v);
  std::ranges::sort(near.vertex);
  for (const int v : near.vertex) {
    number.set(v, static_cast<int>(near.mesh.position.size()));
    near.mesh.position.push_back(mesh.position[v]);
    near.mesh.gradient.push_back(mesh.gradient[v]);
  }
  for (const int t : near.triangle) {
    Triangle& triangle = near.mesh.triangles.emplace_back(mesh.triangles[t]);
    for (int& v : triangle) v = number.find(v);
  }
  return near;
}

Hole hole_in(const TriangleMesh& mesh, const SampledField& lattice, const CellRegion& region,
             const CellRegion& around) {
  enum Place : char { outside, near, inside };
  std::vector<char> place(mesh.vertex_count());
  for (std::size_t v = 0; v < place.size(); ++v) {
    const LatticeCell cell = cell_of(lattice, mesh.position[v]);
    place[v] = region.has(cell) ? inside : around.has(cell) ? near : outside;
  }
  Hole hole;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
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
    const std::vector<OnRim> place = on_rim(mesh.vertex_count(), rim);
    const auto moved = std::stable_partition(hole.kept.begin(), hole.kept.end(), [&](int t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const auto [least, most] = std::minmax({place[a], place[b], place[c]});
      return most != OnRim::pinched && (least == OnRim::no || !has_edges_along(mesh.triangles[t], edges));
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
  for (const LatticeCell& cell : cells_of(setting.lattice, mesh, hole.removed))
    for (int a = 0; a < 3; ++a) {
      block.first[a] = std::min(block.first[a], cell[a]);
      block.last[a] = std::max(block.last[a], cell[a] + 1);
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
  const KeptTriangles kept(mesh, hole.kept, kGap * setting.edge_length);
  patch.iso = local_isosurface(setting.field, lattice, fine, setting.tolerance,
                               seeds_of(setting.lattice, mesh, hole, region, finer),
                               [&](const Vec3& x, const Vec3& g) { return kept.is_near(x, g); });
  patch.triangles = std::move(patch.iso.triangles);
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
