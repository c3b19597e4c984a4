// Edits that are decided on many at once, and made one after the other. Private to this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/parallel.h"
#include "surface/mesh/mesh_edits.h"

namespace kappaflow {

/// What a decision rests on besides what never changes: the triangles around these vertices, and around all
/// up to `reach` edges from them.
struct Grounds {
  std::array<int, 4> vertices{};
  int reach = 0;

  bool hold(const MeshEdits& edits, std::uint32_t made) const {
    return std::ranges::all_of(vertices, [&](int v) { return edits.is_as_it_was(v, reach, made); });
  }
};

/// That the two triangles at an edge are as they were.
inline Grounds edge_grounds(const MeshEdits& edits, int h) {
  const int t = edits.twin(h);
  return {{edits.origin(h), edits.end(h), edits.apex(h), edits.apex(t)}};
}
/// The same of a triangle; of one that is removed nothing can change any more.
inline Grounds triangle_grounds(const MeshEdits& edits, int triangle) {
  const auto& [a, b, c] = edits.mesh().triangles[triangle];
  return a < 0 ? Grounds{} : Grounds{{a, b, c, c}};
}

/// The same as make(decide(i)) for i in [0, n), one after the other; but where there are several threads,
/// most decisions are made ahead, in parallel: one whose grounds no edit has touched since would be the same
/// now. The others are made anew. decide: reads the mesh and no more; what it returns has `grounds`.
template <class Decide, class Make>
void edit_in_order(const MeshEdits& edits, std::size_t n, const Decide& decide, const Make& make) {
  constexpr std::size_t kLeast = 64, kShare = 16;  // so few at a time that edits touch the grounds of few
  constexpr std::size_t kGrain = 8;
  const std::size_t batch = parallel_threads() > 1 ? std::max(kLeast, n / kShare) : 1;
  std::vector<std::invoke_result_t<Decide, std::size_t>> ahead(std::min(batch, n));
  for (std::size_t first = 0; first < n; first += batch) {
    const std::size_t count = std::min(batch, n - first);
    const std::uint32_t made = edits.made();
    parallel_for(
        count, [&](std::size_t i) { ahead[i] = decide(first + i); }, kGrain);
    for (std::size_t i = 0; i < count; ++i)
      make(ahead[i].grounds.hold(edits, made) ? ahead[i] : decide(first + i));
  }
}

}  // namespace kappaflow
