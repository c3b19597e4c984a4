// Repair of triangles with small angles.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surface/remesh/remesh_pass.h"

namespace kappaflow {

bool RemeshPass::is_sharp(int triangle) const {
  const auto& [a, b, c] = mesh_.triangles[triangle];
  return a >= 0 && sharpness(at(a), at(b), at(c)) > kSharp;
}

/// Returns whether an edit was made.
bool RemeshPass::repair_sharp_triangles() {
  bool repaired = false;
  s_.flag_.resize(edits_.half_edges() / 3);
  parallel_for(s_.flag_.size(), [&](std::size_t t) { s_.flag_[t] = is_sharp(static_cast<int>(t)); });
  for (int t = 0; t < static_cast<int>(s_.flag_.size()); ++t) {
    if (!s_.flag_[t] || !is_sharp(t)) continue;  // an edit before may have mended it
    int shortest = 3 * t;
    for (const int h : {3 * t + 1, 3 * t + 2})
      if ((at(edits_.end(h)) - at(edits_.origin(h))).squaredNorm() <
          (at(edits_.end(shortest)) - at(edits_.origin(shortest))).squaredNorm())
        shortest = h;
    repaired |= collapse_either_way(shortest, true) || replace_a_corner(t);
  }
  return repaired;
}

/// The corner whose triangles gain most.
bool RemeshPass::replace_a_corner(int triangle) {
  int best = -1;
  double best_sharp = 1;
  Vec3 best_place = Vec3::Zero();
  for (const int v : mesh_.triangles[triangle]) {
    double sharp = 1;
    const std::optional<Vec3> place = better_place(v, sharp);
    if (!place || !(sharp < best_sharp)) continue;
    best = v;
    best_sharp = sharp;
    best_place = *place;
  }
  return best >= 0 && replace(best, best_place);
}

/// On the way from v to the centroid of its neighbours, in the tangent plane; sharp: of the triangles then.
std::optional<Vec3> RemeshPass::better_place(int v, double& sharp) const {
  Vec3 sum = Vec3::Zero();
  int neighbours = 0;
  edits_.for_each_out(v, [&](int out) {
    sum += at(edits_.end(out)) - at(v);
    ++neighbours;
  });
  const Vec3 n = s_.normal_[v], move = sum / neighbours, tangential = move - move.dot(n) * n;
  const Worst before = fan(v);
  std::optional<Vec3> best;
  sharp = before.sharpness - kGain;
  for (const double share : {1.0, 0.5}) {
    const Worst after = fan_moved(v, at(v) + share * tangential, n);
    if (!(after.sharpness < sharp) || !after.faces_fairly(before)) continue;
    sharp = after.sharpness;
    best = at(v) + share * tangential;
  }
  return best;
}

/// Weights of x in the triangle of v that it lies in, seen along the normal of v; of the nearest otherwise.
VertexBlend RemeshPass::blend_around(int v, const Vec3& x) const {
  VertexBlend best{{v, v, v}, {1, 0, 0}};
  double best_least = -1e300;
  const Vec3 n = s_.normal_[v], d = x - at(v);
  edits_.for_each_out(v, [&](int out) {
    const int b = edits_.end(out), c = edits_.apex(out);
    const Vec3 eb = at(b) - at(v), ec = at(c) - at(v);
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
bool RemeshPass::leaves_surface(int v, const Vec3& x) const {
  bool off = false;
  edits_.for_each_out(
      v, [&](int out) { off = off || is_off((x + at(edits_.end(out)) + at(edits_.apex(out))) / 3); });
  return off;
}

bool RemeshPass::replace(int v, const Vec3& x) {
  const Projected projected = project(field_, x, projection_);
  if (!projected.converged) return false;
  const Worst before = fan(v), after = fan_moved(v, projected.position, -projected.gradient.normalized());
  if (!(after.sharpness <= before.sharpness - kGain) || !after.faces_fairly(before) ||
      spoils_lattice(v, projected.position) || leaves_surface(v, projected.position) ||
      (!after.faces_well(before) && would_cross(fan_triangles(v), projected.position)))
    return false;
  const VertexBlend from = blend_around(v, projected.position);
  edits_.replace(v, from, projected.position);
  add_facts(projected, from);
  ++counts.replaced;
  return true;
}

}  // namespace kappaflow
