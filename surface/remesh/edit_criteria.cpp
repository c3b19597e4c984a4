#include "surface/remesh/edit_criteria.h"

#include <array>

#include "core/sort_unique.h"
#include "core/triangle_geometry.h"
#include "surface/mesh/self_intersection.h"

namespace kappaflow {
namespace {

constexpr int kCrossingRings = 2;  // of triangles that an edit might pass through
constexpr double kChord =
    0.15;                       // distance of a triangle from f = 0 that calls for smaller ones [edge_length]
constexpr double kBend = 0.4;   // length times turn of the normal whose chord is surely nearer [edge_length]
constexpr double kBent = 0.99;  // length aimed at [edge_length] above which the surface counts as flat

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
  const MeshEdits& edits = state.edits;
  const std::vector<Triangle>& mesh_triangles = edits.mesh().triangles;
  const auto is_old = [&](int t) { return std::ranges::count(old, t) > 0; };
  std::vector<int> around(old.begin(), old.end());
  for (int ring = 0; ring < kCrossingRings; ++ring) {
    for (std::size_t i = 0, n = around.size(); i < n; ++i)
      for (const int v : mesh_triangles[around[i]])
        edits.for_each_out(v, [&](int out) { around.push_back(out / 3); });
    sort_unique(around);
  }
  std::vector<Triangle> triangles;
  for (const int t : around)
    if (!is_old(t)) triangles.push_back(mesh_triangles[t]);
  const std::size_t staying = triangles.size();
  for (const int t : old)
    for (int h = 3 * t; h < 3 * t + 3; ++h)
      if (const int u = edits.origin(h), v = edits.end(h);
          !is_old(edits.twin(h) / 3) && u != apex && v != apex)
        triangles.push_back({u, v, apex});
  return !intersecting_triangles(edits.mesh().position, triangles, staying).empty();
}

bool would_cross(RemeshState& state, std::span<const int> old, const Vec3& x) {
  const bool crosses = would_cross(state, old, state.edits.try_vertex(x, Vec3::Zero()));
  state.edits.discard_tried();
  return crosses;
}

}  // namespace kappaflow
