// Lawson's flips towards a Delaunay triangulation; the smallest angle grows with each, so that they end.
#include <array>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"

namespace kappaflow {
namespace {

bool is_delaunay_edge(const RemeshState& state, int h) {
  const MeshEdits& edits = state.edits;
  return is_delaunay(state.at(edits.origin(h)), state.at(edits.end(h)), state.at(edits.apex(h)),
                     state.at(edits.apex(edits.twin(h))));
}

bool flip(const RemeshSetting& setting, int h, RemeshState& state) {
  if (is_delaunay_edge(state, h)) return false;
  MeshEdits& edits = state.edits;
  const int u = edits.origin(h), v = edits.end(h), a = edits.apex(h), b = edits.apex(edits.twin(h));
  WorstOf before, after;
  add_to(before, state, u, v, a);
  add_to(before, state, v, u, b);
  add_to(after, state, u, b, a);
  add_to(after, state, v, a, b);
  if (!(after.sharpness < before.sharpness) || !after.faces_fairly(before)) return false;
  const Vec3 facing_before = triangle_normal(state, u, v, a) + triangle_normal(state, v, u, b);
  if (facing(state.at(u), state.at(b), state.at(a), facing_before) < kSteep ||
      facing(state.at(v), state.at(a), state.at(b), facing_before) < kSteep ||
      is_off_surface(setting, state, {u, b, a}) || is_off_surface(setting, state, {v, a, b}) ||
      (!after.faces_well(before) && would_cross(state, std::array{h / 3, edits.twin(h) / 3}, a)) ||
      !edits.flip(h))
    return false;
  ++state.counts.flips;
  return true;
}

}  // namespace

void flip_towards_delaunay(const RemeshSetting& setting, RemeshState& state) {
  MeshEdits& edits = state.edits;
  state.flag.resize(edits.half_edges());
  parallel_for(state.flag.size(), [&](std::size_t i) {
    const int h = static_cast<int>(i);
    state.flag[h] = !edits.is_removed(h) && h < edits.twin(h) && !is_delaunay_edge(state, h);
  });
  state.pending.clear();
  for (int h = edits.half_edges() - 1; h >= 0; --h)
    if (state.flag[h]) state.pending.push_back(h);
  while (!state.pending.empty()) {
    const int h = state.pending.back();
    state.pending.pop_back();
    const int right = edits.twin(h) / 3, left = h / 3;
    if (!flip(setting, h, state)) continue;
    for (const int around : {3 * left, 3 * left + 2, 3 * right, 3 * right + 2})
      state.pending.push_back(around);
  }
}

}  // namespace kappaflow
