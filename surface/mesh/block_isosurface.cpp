#include "surface/mesh/block_isosurface.h"

#include <map>

#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/lattice_edges.h"

namespace kappaflow {
namespace {

/// The surface as it grows block by block.
class BlockSurface {
 public:
  void add(const SampledField& samples) {
    samples_ = &samples;
    vertex_.assign(3 * samples.value.size(), -1);
    LatticePoint cell;
    for (cell[2] = 0; cell[2] < samples.dims[2] - 1; ++cell[2])
      for (cell[1] = 0; cell[1] < samples.dims[1] - 1; ++cell[1])
        for (cell[0] = 0; cell[0] < samples.dims[0] - 1; ++cell[0]) add_triangles(cell);
  }

  std::vector<Vec3> position;
  std::vector<Triangle> triangles;

 private:
  void add_triangles(const LatticePoint& cell) {
    for (const int* edge = triangles_of_cell(*samples_, cell); *edge >= 0; edge += 3)
      triangles.push_back({vertex_on(cell, edge[0]), vertex_on(cell, edge[1]), vertex_on(cell, edge[2])});
  }

  int vertex_on(const LatticePoint& cell, int edge) {
    const LatticePoint from = moved(cell, kCellEdges[edge].from);
    const int axis = kCellEdges[edge].axis;
    int& known = vertex_[3 * point_index(*samples_, from) + axis];
    if (known >= 0) return known;
    const int next = static_cast<int>(position.size());
    known = is_on_side(from, axis)
                ? on_sides_
                      .try_emplace({from[0] + samples_->first_column, from[1] + samples_->first_row,
                                    from[2] + samples_->first_plane, axis},
                                   next)
                      .first->second
                : next;
    if (known == next) position.push_back(place(from, axis));
    return known;
  }

  bool is_on_side(const LatticePoint& from, int axis) const {
    for (int a = 0; a < 3; ++a)
      if (a != axis && (from[a] == 0 || from[a] == samples_->dims[a] - 1)) return true;
    return false;
  }

  /// By linear interpolation.
  Vec3 place(const LatticePoint& from, int axis) const {
    LatticePoint to = from;
    ++to[axis];
    const double f = samples_->value[point_index(*samples_, from)],
                 share = f / (f - samples_->value[point_index(*samples_, to)]);
    Vec3 x(from[0] + samples_->first_column, from[1] + samples_->first_row, from[2] + samples_->first_plane);
    x[axis] += share;
    return samples_->origin + samples_->spacing * x;
  }

  const SampledField* samples_ = nullptr;
  std::vector<int> vertex_;  // of the block, on the three edges that start at each point
  std::map<std::array<int, 4>, int>
      on_sides_;  // of the lattice: where an edge on a block's side starts, axis
};

}  // namespace

TriangleMesh isosurface_in_blocks(const SampledField& lattice, std::span<const LatticeBlock> blocks,
                                  const std::function<void(SampledField&)>& sample) {
  BlockSurface surface;
  SampledField samples = lattice;
  for (const LatticeBlock& block : blocks) {
    restrict_to(block, samples);
    sample(samples);
    move_off_zero(samples);
    surface.add(samples);
  }
  return make_triangle_mesh(std::move(surface.position), std::move(surface.triangles));
}

}  // namespace kappaflow
