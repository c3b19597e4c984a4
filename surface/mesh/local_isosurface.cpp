#include "surface/mesh/local_isosurface.h"

#include <array>
#include <utility>

#include "core/parallel.h"
#include "surface/mesh/lattice_edges.h"

namespace kappaflow {
namespace {

/// Marching cubes that follows the surface from cell to cell, those of equal distance from the seeds at once.
class LocalExtraction {
 public:
  LocalExtraction(const Field& field, const SampledField& samples, double tolerance, const EndsAt& ends_at)
      : field_(field),
        samples_(samples),
        tolerance_(tolerance),
        ends_at_(ends_at),
        vertex_(3 * samples.value.size(), -1),
        visited_(samples.value.size(), 0) {}

  /// A cell that the surface passes through is worked on in the next march().
  void seed(const LatticePoint& cell) {
    for (int a = 0; a < 3; ++a)
      if (cell[a] < 0 || cell[a] >= samples_.dims[a] - 1) return;
    char& visited = visited_[index(cell)];
    if (visited) return;
    visited = 1;
    if (*triangles_of_cell(samples_, cell) >= 0) front_.push_back(cell);
  }

  LocalIsosurface march() {
    while (!front_.empty()) {
      const std::vector<LatticePoint> cells = std::exchange(front_, {});
      number_vertices(cells);
      place_vertices();
      for (const LatticePoint& cell : cells) add_triangles(cell);
      for (const LatticePoint& cell : cells) go_on_from(cell);
    }
    return std::move(result_);
  }

 private:
  std::size_t index(const LatticePoint& p) const { return point_index(samples_, p); }
  Vec3 place(const LatticePoint& p) const {
    return samples_.origin + samples_.spacing * Vec3(p[0], p[1], p[2] + samples_.first_plane);
  }
  int& vertex_on(const LatticePoint& cell, int edge) {
    return vertex_[3 * index(moved(cell, kCellEdges[edge].from)) + kCellEdges[edge].axis];
  }
  /// Calls visit(edges) for every triangle of the cell; edges: of the cell, three of them.
  template <class Visit>
  void for_each_triangle(const LatticePoint& cell, const Visit& visit) const {
    for (const int* edge = triangles_of_cell(samples_, cell); *edge >= 0; edge += 3) visit(edge);
  }

  void number_vertices(const std::vector<LatticePoint>& cells) {
    for (const LatticePoint& cell : cells)
      for_each_triangle(cell, [&](const int* edges) {
        for (int c = 0; c < 3; ++c) {
          int& vertex = vertex_on(cell, edges[c]);
          if (vertex >= 0) continue;
          vertex = static_cast<int>(edge_.size());
          edge_.push_back({moved(cell, kCellEdges[edges[c]].from), kCellEdges[edges[c]].axis});
        }
      });
  }

  void place_vertices() {
    const std::size_t first = result_.position.size(), n = edge_.size();
    result_.position.resize(n);
    result_.gradient.resize(n);
    result_.exact.resize(n);
    result_.at_side.resize(n);
    ended_.resize(n);
    parallel_for(
        n - first, [&](std::size_t i) { place_vertex(first + i); }, 16);
  }

  void place_vertex(std::size_t v) {
    const auto& [from, axis] = edge_[v];
    LatticePoint to = from;
    ++to[axis];
    const double f = samples_.value[index(from)], share = f / (f - samples_.value[index(to)]);
    const Vec3 start = place(from), end = place(to);
    const LatticeVertex found = find_on_edge(field_, start + share * (end - start), start, end, tolerance_);
    result_.position[v] = found.position;
    result_.gradient[v] = found.gradient;
    result_.exact[v] = found.exact;
    for (int a = 0; a < 3; ++a)
      if (a != axis && (from[a] == 0 || from[a] == samples_.dims[a] - 1)) result_.at_side[v] = 1;
    ended_[v] = ends_at_(found.position, found.gradient);
  }

  void add_triangles(const LatticePoint& cell) {
    for_each_triangle(cell, [&](const int* edges) {
      const Triangle t{vertex_on(cell, edges[0]), vertex_on(cell, edges[1]), vertex_on(cell, edges[2])};
      if (!ended_[t[0]] && !ended_[t[1]] && !ended_[t[2]]) result_.triangles.push_back(t);
    });
  }

  /// To the cells around each edge of this one on which the surface does not end.
  void go_on_from(const LatticePoint& cell) {
    for_each_triangle(cell, [&](const int* edges) {
      for (int c = 0; c < 3; ++c) {
        if (ended_[vertex_on(cell, edges[c])]) continue;
        const auto& [from, axis] = kCellEdges[edges[c]];
        const int b = (axis + 1) % 3, d = (axis + 2) % 3;
        LatticePoint next = moved(cell, from);
        next[axis] = cell[axis];
        seed(next);
        --next[b];
        seed(next);
        --next[d];
        seed(next);
        ++next[b];
        seed(next);
      }
    });
  }

  const Field& field_;
  const SampledField& samples_;
  double tolerance_;
  const EndsAt& ends_at_;
  std::vector<int> vertex_;  // on the three edges that start at each point; -1: none yet
  std::vector<char> visited_;
  std::vector<LatticePoint> front_;
  std::vector<LatticeEdge> edge_;  // of each vertex
  std::vector<char> ended_;        // likewise
  LocalIsosurface result_;
};

}  // namespace

LocalIsosurface local_isosurface(const Field& field, const SampledField& lattice, const LatticeBlock& block,
                                 double tolerance, std::span<const std::array<int, 3>> seeds,
                                 const EndsAt& ends_at) {
  SampledField samples;
  samples.spacing = lattice.spacing;
  samples.origin = lattice.origin + lattice.spacing * Vec3(block.first[0], block.first[1], 0);
  samples.first_plane = block.first[2];
  for (int a = 0; a < 3; ++a) samples.dims[a] = block.last[a] - block.first[a] + 1;
  field.sample(samples);
  move_off_zero(samples);
  LocalExtraction extraction(field, samples, tolerance, ends_at);
  for (const LatticePoint& cell : seeds)
    extraction.seed({cell[0] - block.first[0], cell[1] - block.first[1], cell[2] - block.first[2]});
  return extraction.march();
}

}  // namespace kappaflow
