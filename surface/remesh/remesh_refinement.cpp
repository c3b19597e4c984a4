// Refinement where triangles are off the surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "surface/remesh/remesh_pass.h"

namespace kappaflow {
namespace {

constexpr double kChord =
    0.15;  // distance of a triangle from f = 0 that calls for smaller ones [edge_length]
constexpr double kFlatShare = 0.5;  // of an edge's length that counts where the normals at its ends agree
constexpr double kBend = 0.4;   // length times turn of the normal whose chord is surely nearer [edge_length]
constexpr double kBent = 0.99;  // length aimed at [edge_length] above which the surface counts as flat
constexpr double kHalf = 0.35;  // least half of an edge that is divided, in smallest lengths aimed at
constexpr double kAlong = 0.6;  // cosine to the surface's normal of a triangle that may turn as it has to

}  // namespace

/// Puts vertices where triangles are off the surface, at tips, at rims and in valleys narrower than they, and
/// where those are that come of it.
void RemeshPass::refine_off_surface() {
  std::vector<int>& suspects = s_.suspects_;
  std::vector<char>& off = s_.flag_;
  suspects.resize(mesh_.triangles.size());
  std::iota(suspects.begin(), suspects.end(), 0);
  for (int round = 0; round < kRounds && !suspects.empty(); ++round) {
    off.resize(suspects.size());
    parallel_for(off.size(), [&](std::size_t i) { off[i] = is_off_surface(mesh_.triangles[suspects[i]]); });
    const int first_new = static_cast<int>(mesh_.vertex_count());
    for (std::size_t i = 0; i < off.size(); ++i)  // an edit before may have mended it
      if (off[i] && is_off_surface(mesh_.triangles[suspects[i]])) refine(suspects[i]);
    suspects.clear();
    for (int v = first_new; v < static_cast<int>(mesh_.vertex_count()); ++v)
      edits_.for_each_out(v, [&](int out) { suspects.push_back(out / 3); });
  }
}

/// Divides an edge or, where that would fold something, the triangle; none whose parts would be too short.
void RemeshPass::refine(int triangle) {
  const int h = most_bent_edge(triangle), u = edits_.origin(h), v = edits_.end(h), a = edits_.apex(h);
  const double length = (at(u) - at(v)).norm();
  if (length <= 2 * kHalf * options_.finest * options_.edge_length) return;
  const auto nearby = [&](const Vec3& x) {
    const Projected projected = project(field_, x, projection_);
    return projected.converged && (projected.position - x).norm() < length ? std::optional(projected)
                                                                           : std::nullopt;
  };
  if (const auto middle = nearby(0.5 * (at(u) + at(v)));
      middle && may_join(std::array{triangle, edits_.twin(h) / 3}, middle->position)) {
    edits_.split(h, 0.5, middle->position);
    add_facts(*middle, {{u, v, v}, {0.5, 0.5, 0}});
  } else if (const auto centre = nearby((at(u) + at(v) + at(a)) / 3);
             centre && may_join(std::array{triangle}, centre->position)) {
    const VertexBlend blend{{u, v, a}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    edits_.split(triangle, blend, centre->position);
    add_facts(*centre, blend);
  } else {
    return;
  }
  ++counts.splits;
}

/// Whether triangles that join x with the edges around the old ones may stand for these: each passes through
/// none around, and hardly turns or, where the old ones cut through a tip or a rim, faces along the surface.
/// The normals at the corners do not tell there: they may point in opposite directions.
bool RemeshPass::may_join(std::span<const int> old, const Vec3& x) {
  for (const int t : old) {
    const auto& [a, b, c] = mesh_.triangles[t];
    if (!guard_.allows(at(a), at(b), at(c), x)) return false;
    const Vec3 before = normal(a, b, c);
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      if (std::ranges::count(old, edits_.twin(h) / 3) > 0) continue;
      const Vec3 &p = at(edits_.origin(h)), &q = at(edits_.end(h));
      if (facing(p, q, x, before) < kSteep &&
          facing(p, q, x, -field_.value_and_gradient((p + q + x) / 3).g) < kAlong)
        return false;
    }
  }
  return !would_cross(old, x);
}

/// The field is not asked where the surface is flat, and where the normals at the corners hardly turn along
/// so short a triangle that faces along them.
bool RemeshPass::is_off_surface(const Triangle& triangle) const {
  const auto& [a, b, c] = triangle;
  const double unit = options_.edge_length;
  if (std::min({s_.target_[a], s_.target_[b], s_.target_[c]}) > kBent * unit) return false;
  double bend = 0;
  for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
    bend = std::max(bend, (at(v) - at(u)).norm() * (s_.normal_[v] - s_.normal_[u]).norm());
  const Vec3 normals = s_.normal_[a] + s_.normal_[b] + s_.normal_[c];
  if (bend < kBend * unit && facing(at(a), at(b), at(c), normals) > Worst::kFacing) return false;
  return is_off((at(a) + at(b) + at(c)) / 3);
}

bool RemeshPass::is_off(const Vec3& centroid) const {
  const ValueAndGradient at_centroid = field_.value_and_gradient(centroid);
  return std::abs(at_centroid.f) > kChord * options_.edge_length * at_centroid.g.norm();
}

/// The half-edge of the triangle that is longest, one along which the normal turns counting for more.
int RemeshPass::most_bent_edge(int triangle) const {
  const auto bend = [&](int h) {
    const int u = edits_.origin(h), v = edits_.end(h);
    return (at(v) - at(u)).norm() * (kFlatShare + (s_.normal_[v] - s_.normal_[u]).norm());
  };
  int most = 3 * triangle;
  for (const int h : {most + 1, most + 2})
    if (bend(h) > bend(most)) most = h;
  return most;
}

/// Whether the triangles that a collapse of h makes are off the surface.
bool RemeshPass::leaves_surface(int h) const {
  const int v = edits_.end(h), left = h / 3, right = edits_.twin(h) / 3;
  bool off = false;
  edits_.for_each_out(edits_.origin(h), [&](int out) {
    off = off ||
          (out / 3 != left && out / 3 != right && is_off_surface({v, edits_.end(out), edits_.apex(out)}));
  });
  return off;
}

}  // namespace kappaflow
