#include "surface/mesh/vertex_rings.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace kappaflow {

VertexRings vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles) {
  VertexRings rings;
  vertex_rings(vertex_count, triangles, rings);
  return rings;
}

void vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles, VertexRings& rings) {
  // Every triangle tells each of its corners of the two others; inside a closed mesh each neighbour comes
  // twice.
  rings.start.assign(vertex_count + 1, 0);
  for (const Triangle& triangle : triangles)
    for (const int v : triangle) rings.start[v + 1] += 2;
  std::partial_sum(rings.start.begin(), rings.start.end(), rings.start.begin());

  rings.neighbour.resize(6 * triangles.size());
  std::vector<int> end(rings.start.begin(), rings.start.end() - 1);
  for (const Triangle& triangle : triangles)
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangle[corner];
      rings.neighbour[end[v]++] = triangle[(corner + 1) % 3];
      rings.neighbour[end[v]++] = triangle[(corner + 2) % 3];
    }

  parallel_for(vertex_count, [&](std::size_t v) {
    const auto begin = rings.neighbour.begin() + rings.start[v], last = rings.neighbour.begin() + end[v];
    std::sort(begin, last);
    end[v] = rings.start[v] + static_cast<int>(std::unique(begin, last) - begin);
  });
  int kept = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const int first = std::exchange(rings.start[v], kept);
    std::copy(rings.neighbour.begin() + first, rings.neighbour.begin() + end[v],
              rings.neighbour.begin() + kept);
    kept += end[v] - first;
  }
  rings.start[vertex_count] = kept;
  rings.neighbour.resize(kept);
}

}  // namespace kappaflow
