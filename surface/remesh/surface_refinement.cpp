// Refinement where triangles are off the surface.
#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "core/parallel.h"
#include "surface/remesh/edit_criteria.h"
#include "surface/remesh/edits_ahead.h"

namespace kappaflow {
namespace {

constexpr int kRefinements = 3;     // rounds, each where the one before has put vertices
constexpr double kFlatShare = 0.5;  // of an edge's length that counts where the normals at its ends agree
constexpr double kHalf = 0.35;      // least half of an edge that is divided, in smallest lengths aimed at
constexpr double kAlong = 0.6;      // cosine to the surface's normal of a triangle that may turn as it has to

/// The half-edge of the triangle that is longest, one along which the normal turns counting for more.
int most_bent_edge(const RemeshState& state, int triangle) {
  const auto bend = [&](int h) {
    const int u = state.edits.origin(h), v = state.edits.end(h);
    return (state.at(v) - state.at(u)).norm() * (kFlatShare + (state.normal[v] - state.normal[u]).norm());
  };
  int most = 3 * triangle;
  for (const int h : {most + 1, most + 2})
    if (bend(h) > bend(most)) most = h;
  return most;
}

/// Whether triangles that join x with the edges around the old ones may stand for these: each passes through
/// none around, and hardly turns or, where the old ones cut through a tip or a rim, faces along the surface.
/// The normals at the corners do not tell there: they may point in opposite directions.
bool may_join(const RemeshSetting& setting, const RemeshState& state, std::span<const int> old,
              const Vec3& x) {
  const MeshEdits& edits = state.edits;
  for (const int t : old) {
    const auto& [a, b, c] = edits.mesh().triangles[t];
    const Vec3 before = triangle_normal(state, a, b, c);
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      if (std::ranges::count(old, edits.twin(h) / 3) > 0) continue;
      const Vec3 &p = state.at(edits.origin(h)), &q = state.at(edits.end(h));
      if (facing(p, q, x, before) < kSteep &&
          facing(p, q, x, -setting.field.value_and_gradient((p + q + x) / 3).g) < kAlong)
        return false;
    }
  }
  return !would_cross(state, old, x);
}

/// x put on the surface, unless that is further than `reach` away.
std::optional<Projected> nearby(const RemeshSetting& setting, const Vec3& x, double reach) {
  const Projected projected = project(setting.field, x, setting.projection);
  if (!projected.converged || !((projected.position - x).norm() < reach)) return std::nullopt;
  return projected;
}

/// A vertex that may be put into a triangle or, where that is better, on its edge.
struct Division {
  Grounds grounds;
  int half_edge = -1, triangle = -1;  ///< one of them; neither: there is none
  VertexBlend from{};
  Projected vertex{};
};

bool divide_edge(const RemeshSetting& setting, const RemeshState& state, int h, double length,
                 Division& division) {
  const MeshEdits& edits = state.edits;
  const int u = edits.origin(h), v = edits.end(h);
  const auto middle = nearby(setting, 0.5 * (state.at(u) + state.at(v)), length);
  if (!middle || !edits.can_split(h, middle->position) ||
      !may_join(setting, state, std::array{h / 3, edits.twin(h) / 3}, middle->position))
    return false;
  division.half_edge = h;
  division.from = {{u, v, v}, {0.5, 0.5, 0}};
  division.vertex = *middle;
  return true;
}

void divide_triangle(const RemeshSetting& setting, const RemeshState& state, int h, double length,
                     Division& division) {
  const MeshEdits& edits = state.edits;
  const VertexBlend thirds{{edits.origin(h), edits.end(h), edits.apex(h)}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
  const auto& [u, v, a] = thirds.vertex;
  const auto centre = nearby(setting, (state.at(u) + state.at(v) + state.at(a)) / 3, length);
  if (!centre || !edits.can_split_triangle(h / 3, centre->position) ||
      !may_join(setting, state, std::array{h / 3}, centre->position))
    return;
  division.triangle = h / 3;
  division.from = thirds;
  division.vertex = *centre;
}

/// Of an edge or, where that would fold something, of the triangle; of none whose parts would be too short.
Division find_division(const RemeshSetting& setting, const RemeshState& state, int triangle) {
  const MeshEdits& edits = state.edits;
  Division found{.grounds = triangle_grounds(edits, triangle)};
  const int h = most_bent_edge(state, triangle);
  const double length = (state.at(edits.origin(h)) - state.at(edits.end(h))).norm();
  if (length <= 2 * kHalf * setting.options.finest * setting.options.edge_length) return found;
  found.grounds.vertices[3] = edits.apex(edits.twin(h));
  found.grounds.reach = kCrossingReach - 1;  // the triangles that would go have no corners but these
  if (!divide_edge(setting, state, h, length, found)) divide_triangle(setting, state, h, length, found);
  return found;
}

void divide(const Division& division, RemeshState& state) {
  const Vec3& x = division.vertex.position;
  int m = -1;
  if (division.half_edge >= 0) m = state.edits.split(division.half_edge, 0.5, x);
  if (division.triangle >= 0) m = state.edits.split(division.triangle, division.from, x);
  if (m < 0) return;
  state.add_born(m, division.vertex, division.from);
  ++state.counts.splits;
}

}  // namespace

/// Puts vertices where triangles are off the surface, at tips, at rims and in valleys narrower than they, and
/// where those are that come of it.
void refine_off_surface(const RemeshSetting& setting, RemeshState& state) {
  const TriangleMesh& mesh = state.edits.mesh();
  std::vector<int>& suspects = state.suspects;
  std::vector<char>& off = state.flag;
  suspects.resize(mesh.triangles.size());
  std::iota(suspects.begin(), suspects.end(), 0);
  const auto is_suspect_off = [&](int t) { return is_off_surface(setting, state, mesh.triangles[t]); };
  for (int round = 0; round < kRefinements && !suspects.empty(); ++round) {
    off.resize(suspects.size());
    parallel_for(off.size(), [&](std::size_t i) { off[i] = is_suspect_off(suspects[i]); });
    std::size_t n = 0;
    for (std::size_t i = 0; i < off.size(); ++i)
      if (off[i]) suspects[n++] = suspects[i];
    const int first_new = static_cast<int>(mesh.vertex_count());
    edit_in_order(
        state.edits, n,
        [&](std::size_t i) {
          const int t = suspects[i];  // an edit before may have put it right
          return is_suspect_off(t) ? find_division(setting, state, t)
                                   : Division{.grounds = triangle_grounds(state.edits, t)};
        },
        [&](const Division& division) { divide(division, state); });
    suspects.clear();
    for (int v = first_new; v < static_cast<int>(mesh.vertex_count()); ++v)
      state.edits.for_each_out(v, [&](int out) { suspects.push_back(out / 3); });
  }
}

}  // namespace kappaflow
