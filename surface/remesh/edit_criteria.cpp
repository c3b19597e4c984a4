#include "surface/remesh/edit_criteria.h"

#include <array>

#include "core/sort_unique.h"
#include "core/triangle_crossing.h"
#include "core/triangle_geometry.h"

namespace kappaflow {
namespace {

constexpr int kNewVertex = -1;  // in place of a number
constexpr double kChord =
    0.15;                       // distance of a triangle from f = 0 that calls for smaller ones [edge_length]
constexpr double kBend = 0.4;   // length times turn of the normal whose chord is surely nearer [edge_length]
constexpr double kBent = 0.99;  // length aimed at [edge_length] above which the surface counts as flat

/// A triangle, its corners' places and the box around them.
struct Placed {
  Placed(const Triangle& of, const std::array<Vec3, 3>& places)
      : triangle(of),
        at(places),
        lower(at[0].cwiseMin(at[1]).cwiseMin(at[2])),
        upper(at[0].cwiseMax(at[1]).cwiseMax(at[2])) {}

  Triangle triangle;
  std::array<Vec3, 3> at;
  Vec3 lower, upper;
};

/// Most triangles around an edit are not even near what it adds.
bool cross(const Placed& a, const Placed& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all() &&
         triangles_cross(a.triangle, a.at, b.triangle, b.at);
}

void add_neighbours(const MeshEdits& edits, std::vector<int>& vertices) {
  sort_unique(vertices);
  for (std::size_t i = 0, n = vertices.size(); i < n; ++i)
    edits.for_each_out(vertices[i], [&](int out) { vertices.push_back(edits.end(out)); });
  sort_unique(vertices);
}

/// As would_cross(), for vertex apex at x.
bool any_cross(const RemeshState& state, std::span<const int> old, int apex, const Vec3& x) {
  const MeshEdits& edits = state.edits;
  const auto is_old = [&](int t) { return std::ranges::count(old, t) > 0; };
  std::vector<Placed> added;
  std::vector<int> around;
  for (const int t : old)
    for (int h = 3 * t; h < 3 * t + 3; ++h) {
      const int u = edits.origin(h), v = edits.end(h);
      around.push_back(u);
      if (!is_old(edits.twin(h) / 3) && u != apex && v != apex)
        added.emplace_back(Triangle{u, v, apex}, std::array{state.at(u), state.at(v), x});
    }
  for (std::size_t i = 0; i < added.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (cross(added[i], added[j])) return true;
  for (int ring = 1; ring < kCrossingReach; ++ring) add_neighbours(edits, around);
  return !std::ranges::all_of(around, [&](int v) {
    return edits.all_out(v, [&](int out) {
      if (is_old(out / 3)) return true;
      const Triangle& t = edits.mesh().triangles[out / 3];
      const Placed other(t, {state.at(t[0]), state.at(t[1]), state.at(t[2])});
      return std::ranges::none_of(added, [&](const Placed& one) { return cross(one, other); });
    });
  });
}

}  // namespace

void add_to(WorstOf& worst, const RemeshState& state, const Vec3& x, const Vec3& n, int b, int c) {
  const Vec3 &at_b = state.at(b), &at_c = state.at(c);
  worst.add(sharpness(x, at_b, at_c), facing(x, at_b, at_c, n + state.normal[b] + state.normal[c]));
}

void add_to(WorstOf& worst, const RemeshState& state, int a, int b, int c) {
  add_to(worst, state, state.at(a), state.normal[a], b, c);
}

WorstOf fan(const RemeshState& state, int v) {
  return fan_moved(state, v, state.at(v), state.normal[v]);
}

WorstOf fan_moved(const RemeshState& state, int v, const Vec3& x, const Vec3& n) {
  WorstOf worst;
  state.edits.for_each_out(
      v, [&](int out) { add_to(worst, state, x, n, state.edits.end(out), state.edits.apex(out)); });
  return worst;
}

std::vector<int> fan_triangles(const RemeshState& state, int v) {
  std::vector<int> fan;
  state.edits.for_each_out(v, [&](int out) { fan.push_back(out / 3); });
  return fan;
}

Vec3 triangle_normal(const RemeshState& state, int a, int b, int c) {
  return twice_area_vector(state.at(a), state.at(b), state.at(c)).normalized();
}

bool is_off(const RemeshSetting& setting, const Vec3& centroid) {
  const ValueAndGradient at_centroid = setting.field.value_and_gradient(centroid);
  return std::abs(at_centroid.f) > kChord * setting.options.edge_length * at_centroid.g.norm();
}

bool is_off_surface(const RemeshSetting& setting, const RemeshState& state, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const double unit = setting.options.edge_length;
  if (std::min({state.target[a], state.target[b], state.target[c]}) > kBent * unit) return false;
  double bend = 0;
  for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
    bend = std::max(bend, (state.at(v) - state.at(u)).norm() * (state.normal[v] - state.normal[u]).norm());
  const Vec3 normals = state.normal[a] + state.normal[b] + state.normal[c];
  if (bend < kBend * unit && facing(state.at(a), state.at(b), state.at(c), normals) > WorstOf::kFacing)
    return false;
  return is_off(setting, (state.at(a) + state.at(b) + state.at(c)) / 3);
}

bool would_cross(const RemeshState& state, std::span<const int> old, int apex) {
  return any_cross(state, old, apex, state.at(apex));
}

bool would_cross(const RemeshState& state, std::span<const int> old, const Vec3& x) {
  return any_cross(state, old, kNewVertex, x);
}

}  // namespace kappaflow
