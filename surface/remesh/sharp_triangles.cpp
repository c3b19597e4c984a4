// Repair of triangles with small angles.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"
#include "surface/remesh/edits_ahead.h"

namespace kappaflow {
namespace {

constexpr double kGain = 1e-3;  // least improvement of a smallest angle's cosine which is worth an edit

constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

bool is_sharp(const RemeshState& state, int triangle) {
  const auto& [a, b, c] = state.edits.mesh().triangles[triangle];
  return a >= 0 && sharpness(state.at(a), state.at(b), state.at(c)) > kSharp;
}

int shortest_edge(const RemeshState& state, int triangle) {
  const auto square = [&](int h) {
    return (state.at(state.edits.end(h)) - state.at(state.edits.origin(h))).squaredNorm();
  };
  int shortest = 3 * triangle;
  for (const int h : {3 * triangle + 1, 3 * triangle + 2})
    if (square(h) < square(shortest)) shortest = h;
  return shortest;
}

/// On the way from v to the centroid of its neighbours, in the tangent plane; sharp: of the triangles then.
std::optional<Vec3> better_place(const RemeshState& state, int v, double& sharp) {
  const Vec3& at_v = state.at(v);
  Vec3 sum = Vec3::Zero();
  int neighbours = 0;
  state.edits.for_each_out(v, [&](int out) {
    sum += state.at(state.edits.end(out)) - at_v;
    ++neighbours;
  });
  const Vec3 n = state.normal[v], move = sum / neighbours, tangential = move - move.dot(n) * n;
  const WorstOf before = fan(state, v);
  std::optional<Vec3> best;
  sharp = before.sharpness - kGain;
  for (const double share : {1.0, 0.5}) {
    const WorstOf after = fan_moved(state, v, at_v + share * tangential, n);
    if (!(after.sharpness < sharp) || !after.faces_fairly(before)) continue;
    sharp = after.sharpness;
    best = at_v + share * tangential;
  }
  return best;
}

/// Weights of x in the triangle of v that it lies in, seen along the normal of v; of the nearest otherwise.
VertexBlend blend_around(const RemeshState& state, int v, const Vec3& x) {
  VertexBlend best{{v, v, v}, {1, 0, 0}};
  double best_least = -1e300;
  const Vec3 n = state.normal[v], d = x - state.at(v);
  state.edits.for_each_out(v, [&](int out) {
    const int b = state.edits.end(out), c = state.edits.apex(out);
    const Vec3 eb = state.at(b) - state.at(v), ec = state.at(c) - state.at(v);
    const double twice_area = n.dot(eb.cross(ec));
    const double wb = n.dot(d.cross(ec)) / twice_area, wc = n.dot(eb.cross(d)) / twice_area;
    const double least = std::min({wb, wc, 1 - wb - wc});
    if (!(twice_area > 0) || !(least > best_least)) return;
    best_least = least;
    const double pb = std::max(0.0, wb), pc = std::max(0.0, wc), sum = std::max(1.0, pb + pc);
    best = {{v, b, c}, {1 - (pb + pc) / sum, pb / sum, pc / sum}};
  });
  return best;
}

/// Whether a triangle of v would be off the surface if v were at x.
bool leaves_surface(const RemeshSetting& setting, const RemeshState& state, int v, const Vec3& x) {
  const MeshEdits& edits = state.edits;
  return !edits.all_out(v, [&](int out) {
    return !is_off(setting, (x + state.at(edits.end(out)) + state.at(edits.apex(out))) / 3);
  });
}

bool may_replace(const RemeshSetting& setting, const RemeshState& state, int v, const Projected& by,
                 int& reach) {
  if (!by.converged) return false;
  const WorstOf before = fan(state, v), after = fan_moved(state, v, by.position, -by.gradient.normalized());
  if (!(after.sharpness <= before.sharpness - kGain) || !after.faces_fairly(before) ||
      !state.edits.can_replace(v, by.position) || leaves_surface(setting, state, v, by.position))
    return false;
  if (after.faces_well(before)) return true;
  reach = kCrossingReach;
  return !would_cross(state, fan_triangles(state, v), by.position);
}

/// What puts a sharp triangle right: a collapse or, where there is none, a new vertex in place of one.
struct Repair {
  Grounds grounds;
  int triangle = -1;
  Collapse collapse{};
  int replaced = -1;  ///< vertex; -1: none
  Projected by{};     ///< falls on the surface
};

/// Of the corners the one whose triangles gain most.
void find_replacement(const RemeshSetting& setting, const RemeshState& state, int triangle, Repair& repair) {
  int best = -1;
  double best_sharp = 1;
  Vec3 best_place = Vec3::Zero();
  for (const int v : state.edits.mesh().triangles[triangle]) {
    double sharp = 1;
    const std::optional<Vec3> place = better_place(state, v, sharp);
    if (!place || !(sharp < best_sharp)) continue;
    best = v;
    best_sharp = sharp;
    best_place = *place;
  }
  if (best < 0) return;
  repair.by = project(setting.field, best_place, setting.projection);
  if (may_replace(setting, state, best, repair.by, repair.grounds.reach)) repair.replaced = best;
}

/// None for a triangle that an edit before has put right, nor where there was none and nothing has changed
/// since that this can have rested on.
Repair find_repair(const RemeshSetting& setting, const RemeshState& state, int triangle) {
  const MeshEdits& edits = state.edits;
  Repair found{.grounds = triangle_grounds(edits, triangle), .triangle = triangle};
  if (!is_sharp(state, triangle)) return found;
  found.grounds.reach = kCrossingReach;
  const std::uint32_t refused = state.unrepaired[triangle];
  if (refused != kNever && found.grounds.hold(edits, refused)) return found;
  found.collapse = find_collapse(setting, state, shortest_edge(state, triangle), true);
  found.grounds = found.collapse.grounds;
  if (found.collapse.half_edge < 0) find_replacement(setting, state, triangle, found);
  return found;
}

bool replace(const Repair& repair, RemeshState& state) {
  if (repair.replaced < 0) return false;
  const VertexBlend from = blend_around(state, repair.replaced, repair.by.position);
  const int m = state.edits.replace(repair.replaced, from, repair.by.position);
  if (m < 0) return false;
  state.add_born(m, repair.by, from);
  ++state.counts.replaced;
  return true;
}

}  // namespace

/// A sharp triangle loses its shortest edge or, where that cannot be, one corner to a vertex at a better
/// place.
bool repair_sharp_triangles(const RemeshSetting& setting, bool again, RemeshState& state) {
  const MeshEdits& edits = state.edits;
  const int triangles = edits.half_edges() / 3;
  if (!again) state.unrepaired.assign(triangles, kNever);
  state.flag.resize(triangles);
  parallel_for(state.flag.size(), [&](std::size_t i) {
    const int t = static_cast<int>(i);
    state.flag[t] = is_sharp(state, t);
  });
  state.suspects.clear();
  for (int t = 0; t < triangles; ++t)
    if (state.flag[t]) state.suspects.push_back(t);
  bool repaired = false;
  edit_in_order(
      edits, state.suspects.size(),
      [&](std::size_t i) { return find_repair(setting, state, state.suspects[i]); },
      [&](const Repair& repair) {
        const bool made = make_collapse(repair.collapse, state) || replace(repair, state);
        if (!made) state.unrepaired[repair.triangle] = edits.made();
        repaired |= made;
      });
  return repaired;
}

}  // namespace kappaflow
