// Edges that are too long or too short for the length aimed at.
#include <algorithm>
#include <optional>
#include <tuple>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"
#include "surface/remesh/edits_ahead.h"

namespace kappaflow {
namespace {

constexpr double kShort = 0.6;  // length over the one aimed at: half of a long edge is not short
constexpr double kTooLong = 2;  // likewise, even where a sliver goes for it

/// Candidates are the edges (u, v), u < v, that choose(size) takes; size: length over the length aimed at,
/// not 0.
template <class Choose>
void collect_edges(const Choose& choose, RemeshState& state) {
  constexpr int kPart = 4096;  // half-edges
  const MeshEdits& edits = state.edits;
  state.parts.resize((edits.half_edges() + kPart - 1) / kPart);
  parallel_for(
      state.parts.size(),
      [&](std::size_t part) {
        state.parts[part].clear();
        const int first = static_cast<int>(part) * kPart;
        for (int h = first; h < std::min(first + kPart, edits.half_edges()); ++h) {
          const int u = edits.origin(h), v = edits.end(h);
          if (edits.is_removed(h) || u >= v) continue;
          const double size = (state.at(v) - state.at(u)).norm() / state.aimed_at(u, v);
          if (size > 0 && choose(size)) state.parts[part].push_back({size, u, v});
        }
      },
      1);
  state.candidates.clear();
  for (const auto& part : state.parts)
    state.candidates.insert(state.candidates.end(), part.begin(), part.end());
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

/// Whether all edges from v are short enough that come to start at v instead of u.
bool stay_short(const RemeshState& state, int u, int v, double longest) {
  const MeshEdits& edits = state.edits;
  return edits.all_out(u, [&](int out) {
    const int b = edits.end(out);
    return b == v || !((state.at(b) - state.at(v)).norm() > longest * state.aimed_at(b, v));
  });
}

/// The triangles around u that would stay if it were joined with v, as they would be then; nothing where one
/// would turn too far. turns_sliver: whether one would that does not count, for its normal tells little.
std::optional<WorstOf> fan_joined(const RemeshState& state, int u, int v, bool repair, bool& turns_sliver) {
  const MeshEdits& edits = state.edits;
  WorstOf after;
  const bool fine = edits.all_out(u, [&](int out) {
    const int b = edits.end(out), c = edits.apex(out);
    if (b == v || c == v) return true;
    const Vec3 &at_b = state.at(b), &at_c = state.at(c);
    add_to(after, state, v, b, c);
    if (facing(state.at(v), at_b, at_c, triangle_normal(state, u, b, c)) >= kSteep) return true;
    if (!repair || !(sharpness(state.at(u), at_b, at_c) > WorstOf::kSliver)) return false;
    return turns_sliver = true;
  });
  return fine ? std::optional(after) : std::nullopt;
}

/// Whether the triangles around u would leave the surface if it were joined with v.
bool leaves_surface(const RemeshSetting& setting, const RemeshState& state, int u, int v) {
  const MeshEdits& edits = state.edits;
  return !edits.all_out(u, [&](int out) {
    const int b = edits.end(out), c = edits.apex(out);
    return b == v || c == v || !is_off_surface(setting, state, {v, b, c});
  });
}

/// For the sake of length: the triangles must not become bad, or no worse than they are.
bool may_shorten(const RemeshSetting& setting, const RemeshState& state, int h) {
  const int u = state.edits.origin(h), v = state.edits.end(h);
  if (!stay_short(state, u, v, kLong)) return false;
  bool turns_sliver = false;
  const std::optional<WorstOf> after = fan_joined(state, u, v, false, turns_sliver);
  if (!after) return false;
  if (after->sharpness > kSharp || after->facing < WorstOf::kFacing) {
    const WorstOf before = fan(state, u);
    if (after->sharpness > std::max(kSharp, before.sharpness) || !after->faces_well(before)) return false;
  }
  return !leaves_surface(setting, state, u, v) && state.edits.can_collapse(h);
}

/// For the sake of a sharp triangle: the triangles must not become worse.
bool may_repair(const RemeshSetting& setting, const RemeshState& state, int h, int& reach) {
  const int u = state.edits.origin(h), v = state.edits.end(h);
  const WorstOf before = fan(state, u);
  if (!stay_short(state, u, v, before.sharpness > WorstOf::kSliver ? kTooLong : kLong)) return false;
  bool turns_sliver = false;
  const std::optional<WorstOf> after = fan_joined(state, u, v, true, turns_sliver);
  if (!after || after->sharpness > before.sharpness || !after->faces_fairly(before) ||
      leaves_surface(setting, state, u, v) || !state.edits.can_collapse(h))
    return false;
  if (!turns_sliver && after->faces_well(before)) return true;
  reach = kCrossingReach;
  return !would_cross(state, fan_triangles(state, u), v);
}

bool may_collapse(const RemeshSetting& setting, const RemeshState& state, int h, bool repair, int& reach) {
  return repair ? may_repair(setting, state, h, reach) : may_shorten(setting, state, h);
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
  edit_in_order(
      state.edits, state.candidates.size(),
      [&](std::size_t i) {
        const auto& [size, u, v] = state.candidates[i];
        const int h = state.edits.find(u, v);
        return h < 0 ? Collapse{{{u, v, u, v}}} : find_collapse(setting, state, h, false);
      },
      [&](const Collapse& collapse) { make_collapse(collapse, state); });
}

/// Vertices off the surface go first, then the younger ones.
Collapse find_collapse(const RemeshSetting& setting, const RemeshState& state, int h, bool repair) {
  const MeshEdits& edits = state.edits;
  const auto rank = [&](int v) { return std::pair(edits.mesh().unprojected[v], v); };
  if (rank(edits.origin(h)) < rank(edits.end(h))) h = edits.twin(h);
  Collapse found{edge_grounds(edits, h)};
  for (const int way : {h, edits.twin(h)}) {
    if (!may_collapse(setting, state, way, repair, found.grounds.reach)) continue;
    found.half_edge = way;
    break;
  }
  return found;
}

bool make_collapse(const Collapse& collapse, RemeshState& state) {
  if (collapse.half_edge < 0 || !state.edits.collapse(collapse.half_edge, true)) return false;
  ++state.counts.collapses;
  return true;
}

}  // namespace kappaflow
