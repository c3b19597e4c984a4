// Repair of triangles with small angles.
#include <algorithm>
#include <optional>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"

namespace kappaflow {
namespace {

constexpr double kGain = 1e-3;  // least improvement of a smallest angle's cosine which is worth an edit

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
  bool off = false;
  edits.for_each_out(v, [&](int out) {
    off = off || is_off(setting, (x + state.at(edits.end(out)) + state.at(edits.apex(out))) / 3);
  });
  return off;
}

/// Puts a new vertex in place of v, where x falls on the surface.
bool replace(const RemeshSetting& setting, int v, const Vec3& x, RemeshState& state) {
  const Projected projected = project(setting.field, x, setting.projection);
  if (!projected.converged) return false;
  const WorstOf before = fan(state, v),
                after = fan_moved(state, v, projected.position, -projected.gradient.normalized());
  if (!(after.sharpness <= before.sharpness - kGain) || !after.faces_fairly(before) ||
      leaves_surface(setting, state, v, projected.position) ||
      (!after.faces_well(before) && would_cross(state, fan_triangles(state, v), projected.position)))
    return false;
  const VertexBlend from = blend_around(state, v, projected.position);
  const int m = state.edits.replace(v, from, projected.position);
  if (m < 0) return false;
  state.add_born(m, projected, from);
  ++state.counts.replaced;
  return true;
}

/// The corner whose triangles gain most.
bool replace_a_corner(const RemeshSetting& setting, int triangle, RemeshState& state) {
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
  return best >= 0 && replace(setting, best, best_place, state);
}

}  // namespace

/// A sharp triangle loses its shortest edge or, where that cannot be, one corner to a vertex at a better
/// place.
bool repair_sharp_triangles(const RemeshSetting& setting, RemeshState& state) {
  bool repaired = false;
  state.flag.resize(state.edits.half_edges() / 3);
  parallel_for(state.flag.size(),
               [&](std::size_t t) { state.flag[t] = is_sharp(state, static_cast<int>(t)); });
  for (int t = 0; t < static_cast<int>(state.flag.size()); ++t)
    if (state.flag[t] && is_sharp(state, t))  // an edit before may have put it right
      repaired |= collapse_either_way(setting, shortest_edge(state, t), true, state) ||
                  replace_a_corner(setting, t, state);
  return repaired;
}

}  // namespace kappaflow
