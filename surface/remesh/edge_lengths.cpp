// Edges that are too long or too short for the length aimed at.
#include <algorithm>
#include <tuple>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"

namespace kappaflow {
namespace {

constexpr double kShort = 0.6;  // length over the one aimed at: half of a long edge is not short
constexpr double kTooLong = 2;  // likewise, even where a sliver goes for it

/// Candidates are the edges (u, v), u < v, that choose(size) takes; size: length over the length aimed at.
template <class Choose>
void collect_edges(const Choose& choose, RemeshState& state) {
  const MeshEdits& edits = state.edits;
  state.size.resize(edits.half_edges());
  parallel_for(state.size.size(), [&](std::size_t i) {
    const int h = static_cast<int>(i);
    const bool counts_once = !edits.is_removed(h) && edits.origin(h) < edits.end(h);
    state.size[h] = counts_once ? (state.at(edits.end(h)) - state.at(edits.origin(h))).norm() /
                                      state.aimed_at(edits.origin(h), edits.end(h))
                                : 0;
  });
  state.candidates.clear();
  for (int h = 0; h < edits.half_edges(); ++h)
    if (state.size[h] > 0 && choose(state.size[h]))
      state.candidates.push_back({state.size[h], edits.origin(h), edits.end(h)});
}

void project_midpoints(const RemeshSetting& setting, RemeshState& state) {
  state.midpoints.resize(state.candidates.size());
  parallel_for(
      state.candidates.size(),
      [&](std::size_t i) {
        const auto& [size, u, v] = state.candidates[i];
        state.midpoints[i] = project(setting.field, 0.5 * (state.at(u) + state.at(v)), setting.projection);
      },
      1);
}

void split(int h, const Projected& midpoint, RemeshState& state) {
  MeshEdits& edits = state.edits;
  const int u = edits.origin(h), v = edits.end(h), a = edits.apex(h), b = edits.apex(edits.twin(h));
  const Vec3& x = midpoint.position;
  const Vec3 &at_u = state.at(u), &at_v = state.at(v);
  if (!midpoint.converged || (x - 0.5 * (at_u + at_v)).norm() > 0.5 * (at_u - at_v).norm()) return;
  WorstOf before, after;
  add_to(before, state, u, v, a);
  add_to(before, state, v, u, b);
  const Vec3 n = -midpoint.gradient.normalized();
  add_to(after, state, x, n, v, a);
  add_to(after, state, x, n, a, u);
  add_to(after, state, x, n, u, b);
  add_to(after, state, x, n, b, v);
  if (!after.faces_well(before)) return;
  const int m = edits.split(h, 0.5, x);
  if (m < 0) return;
  state.add_born(m, midpoint, {{u, v, v}, {0.5, 0.5, 0}});
  ++state.counts.splits;
}

/// repair: whether the triangles must not become worse; else they must not become bad.
bool may_collapse(const RemeshSetting& setting, int h, bool repair, RemeshState& state) {
  MeshEdits& edits = state.edits;
  const int u = edits.origin(h), v = edits.end(h), left = h / 3, right = edits.twin(h) / 3;
  const Vec3 &at_u = state.at(u), &at_v = state.at(v);
  const WorstOf before = fan(state, u);
  WorstOf after;
  const double longest = repair && before.sharpness > WorstOf::kSliver ? kTooLong : kLong;
  bool refused = false, turns_sliver = false;
  edits.for_each_out(u, [&](int out) {
    const int b = edits.end(out), c = edits.apex(out);
    const Vec3 &at_b = state.at(b), &at_c = state.at(c);
    refused |= b != v && (at_b - at_v).norm() > longest * state.aimed_at(b, v);
    if (out / 3 == left || out / 3 == right) return;
    add_to(after, state, v, b, c);
    if (facing(at_v, at_b, at_c, triangle_normal(state, u, b, c)) >= kSteep) return;
    const bool sliver = sharpness(at_u, at_b, at_c) > WorstOf::kSliver;  // its normal tells little
    turns_sliver |= sliver;
    refused |= !repair || !sliver;
  });
  if (refused || !edits.can_collapse(h)) return false;
  const double limit = repair ? before.sharpness : std::max(kSharp, before.sharpness);
  const bool plain = !turns_sliver && after.faces_well(before);
  if (after.sharpness > limit || !(plain || (repair && after.faces_fairly(before)))) return false;
  bool leaves_surface = false;
  edits.for_each_out(u, [&](int out) {
    leaves_surface = leaves_surface || (out / 3 != left && out / 3 != right &&
                                        is_off_surface(setting, state, {v, edits.end(out), edits.apex(out)}));
  });
  return !leaves_surface && (plain || !would_cross(state, fan_triangles(state, u), v));
}

}  // namespace

void split_long_edges(const RemeshSetting& setting, RemeshState& state) {
  collect_edges([](double size) { return size > kLong; }, state);
  std::ranges::sort(state.candidates, [](const auto& a, const auto& b) {
    return std::tuple(-a.size, a.u, a.v) < std::tuple(-b.size, b.u, b.v);
  });
  project_midpoints(setting, state);
  for (std::size_t i = 0; i < state.candidates.size(); ++i)
    split(state.edits.find(state.candidates[i].u, state.candidates[i].v), state.midpoints[i], state);
}

void collapse_short_edges(const RemeshSetting& setting, RemeshState& state) {
  collect_edges([](double size) { return size < kShort; }, state);
  std::ranges::sort(state.candidates, [](const auto& a, const auto& b) {
    return std::tuple(a.size, a.u, a.v) < std::tuple(b.size, b.u, b.v);
  });
  for (const auto& [size, u, v] : state.candidates)
    if (const int h = state.edits.find(u, v); h >= 0) collapse_either_way(setting, h, false, state);
}

/// Vertices off the surface go first, then the younger ones.
bool collapse_either_way(const RemeshSetting& setting, int h, bool repair, RemeshState& state) {
  MeshEdits& edits = state.edits;
  const auto rank = [&](int v) { return std::pair(edits.mesh().unprojected[v], v); };
  if (rank(edits.origin(h)) < rank(edits.end(h))) h = edits.twin(h);
  for (const int way : {h, edits.twin(h)})
    if (may_collapse(setting, way, repair, state) && edits.collapse(way)) {
      ++state.counts.collapses;
      return true;
    }
  return false;
}

}  // namespace kappaflow
