#include "surface/remesh/remeshing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/parallel.h"
#include "surface/mesh/self_intersection.h"
#include "surface/remesh/remesh_pass.h"

namespace kappaflow {
namespace {

constexpr double kGrading = 0.4;   // largest change of the length aimed at per length along the surface
constexpr int kCrossingRings = 2;  // of triangles that an edit might pass through
constexpr int kGradingPasses = 3;  // more follow in the next steps

}  // namespace

/// Normal curvature of the surface along edge (u, v), torsion included [1/m]; 0 where an end is off it.
double RemeshPass::normal_turn(int u, int v) const {
  if (mesh_.unprojected[u] || mesh_.unprojected[v]) return 0;
  return (s_.normal_[v] - s_.normal_[u]).norm() / (at(v) - at(u)).norm();
}

void RemeshPass::set_targets(const VertexRings& rings) {
  const std::size_t n = mesh_.vertex_count();
  s_.normal_.resize(n);
  s_.target_.resize(n);
  s_.smoothed_.resize(n);
  parallel_for(n, [&](std::size_t v) { s_.normal_[v] = -facts_.gradient[v].normalized(); });
  parallel_for(n, [&](std::size_t i) {
    const int v = static_cast<int>(i);
    double curvature = 0;
    for (const int w : rings.of(v)) curvature = std::max(curvature, normal_turn(v, w));
    s_.target_[v] =
        std::clamp(options_.turn / curvature, options_.finest * options_.edge_length, options_.edge_length);
  });
  for (int pass = 0; pass < kGradingPasses; ++pass) {
    parallel_for(n, [&](std::size_t i) {
      const int v = static_cast<int>(i);
      double target = s_.target_[v];
      for (const int w : rings.of(v))
        target = std::min(target, s_.target_[w] + kGrading * (at(w) - at(v)).norm());
      s_.smoothed_[v] = target;
    });
    std::swap(s_.target_, s_.smoothed_);
  }
}

/// Candidates are the edges (u, v), u < v, that choose(size) takes.
template <class Choose>
void RemeshPass::collect_edges(const Choose& choose) {
  s_.size_.resize(edits_.half_edges());
  parallel_for(s_.size_.size(), [&](std::size_t i) {
    const int h = static_cast<int>(i);
    const bool counts_once = !edits_.is_removed(h) && edits_.origin(h) < edits_.end(h);
    s_.size_[h] = counts_once ? (at(edits_.end(h)) - at(edits_.origin(h))).norm() /
                                    aimed_at(edits_.origin(h), edits_.end(h))
                              : 0;
  });
  s_.candidates_.clear();
  for (int h = 0; h < edits_.half_edges(); ++h)
    if (s_.size_[h] > 0 && choose(s_.size_[h]))
      s_.candidates_.push_back({s_.size_[h], edits_.origin(h), edits_.end(h)});
}

void RemeshPass::project_midpoints() {
  s_.midpoints_.resize(s_.candidates_.size());
  parallel_for(
      s_.candidates_.size(),
      [&](std::size_t i) {
        const auto& [size, u, v] = s_.candidates_[i];
        s_.midpoints_[i] = project(field_, 0.5 * (at(u) + at(v)), projection_);
      },
      1);
}

void RemeshPass::split_long_edges() {
  collect_edges([](double size) { return size > kLong; });
  std::ranges::sort(s_.candidates_, [](const auto& a, const auto& b) {
    return std::tuple(-a.size, a.u, a.v) < std::tuple(-b.size, b.u, b.v);
  });
  project_midpoints();
  for (std::size_t i = 0; i < s_.candidates_.size(); ++i)
    split(edits_.find(s_.candidates_[i].u, s_.candidates_[i].v), s_.midpoints_[i]);
}

void RemeshPass::split(int h, const Projected& midpoint) {
  const int u = edits_.origin(h), v = edits_.end(h), a = edits_.apex(h), b = edits_.apex(edits_.twin(h));
  const Vec3& x = midpoint.position;
  if (!midpoint.converged || (x - 0.5 * (at(u) + at(v))).norm() > 0.5 * (at(u) - at(v)).norm()) return;
  Worst before, after;
  add_to(before, u, v, a);
  add_to(before, v, u, b);
  const Vec3 n = -midpoint.gradient.normalized();
  add_to(after, x, n, v, a);
  add_to(after, x, n, a, u);
  add_to(after, x, n, u, b);
  add_to(after, x, n, b, v);
  if (!after.faces_well(before) || !guard_.allows(at(u), at(v), at(a), x) ||
      !guard_.allows(at(v), at(u), at(b), x))
    return;
  const Projected kept = midpoint;
  edits_.split(h, 0.5, kept.position);
  add_facts(kept, {{u, v, v}, {0.5, 0.5, 0}});
  ++counts.splits;
}

void RemeshPass::add_facts(const Projected& projected, const VertexBlend& from) {
  facts_.gradient.push_back(projected.gradient);
  facts_.mobility.push_back(blended(facts_.mobility, from));
  s_.normal_.emplace_back(-projected.gradient.normalized());
  s_.target_.push_back(blended(s_.target_, from));
  counts.residual_max = std::max(counts.residual_max, projected.residual);
}

void RemeshPass::collapse_short_edges() {
  collect_edges([](double size) { return size < kShort; });
  std::ranges::sort(s_.candidates_, [](const auto& a, const auto& b) {
    return std::tuple(a.size, a.u, a.v) < std::tuple(b.size, b.u, b.v);
  });
  for (const auto& [size, u, v] : s_.candidates_)
    if (const int h = edits_.find(u, v); h >= 0) collapse_either_way(h, false);
}

/// Vertices off the surface go first, then the younger ones.
bool RemeshPass::collapse_either_way(int h, bool repair) {
  const auto rank = [&](int v) { return std::pair(mesh_.unprojected[v], v); };
  if (rank(edits_.origin(h)) < rank(edits_.end(h))) h = edits_.twin(h);
  for (const int way : {h, edits_.twin(h)})
    if (may_collapse(way, repair)) {
      edits_.collapse(way);
      ++counts.collapses;
      return true;
    }
  return false;
}

/// repair: whether the triangles must not become worse; else they must not become bad.
bool RemeshPass::may_collapse(int h, bool repair) {
  const int u = edits_.origin(h), v = edits_.end(h), left = h / 3, right = edits_.twin(h) / 3;
  Worst before = fan(u), after;
  const double longest = repair && before.sharpness > Worst::kSliver ? kTooLong : kLong;
  bool refused = false, turns_sliver = false;
  edits_.for_each_out(u, [&](int out) {
    const int b = edits_.end(out), c = edits_.apex(out);
    refused |= b != v && (at(b) - at(v)).norm() > longest * aimed_at(b, v);
    if (out / 3 == left || out / 3 == right) return;
    add_to(after, v, b, c);
    if (facing(at(v), at(b), at(c), normal(u, b, c)) >= kSteep) return;
    const bool sliver = sharpness(at(u), at(b), at(c)) > Worst::kSliver;  // its normal tells little
    turns_sliver |= sliver;
    refused |= !repair || !sliver;
  });
  const double limit = repair ? before.sharpness : std::max(kSharp, before.sharpness);
  const bool plain = !turns_sliver && after.faces_well(before);
  return !refused && after.sharpness <= limit && (plain || (repair && after.faces_fairly(before))) &&
         edits_.can_collapse(h) && !leaves_surface(h) && !spoils_lattice(u, at(v)) &&
         (plain || !would_cross(fan_triangles(u), v));
}

/// Whether the lattice's points tell against moving v to x.
bool RemeshPass::spoils_lattice(int v, const Vec3& x) const {
  bool spoils = false;
  edits_.for_each_out(v, [&](int out) {
    spoils = spoils || !guard_.allows(at(v), at(edits_.end(out)), at(edits_.apex(out)), x);
  });
  return spoils;
}

/// Whether the triangles that join x with the edges around the old ones pass through others nearby.
bool RemeshPass::would_cross(std::span<const int> old, const Vec3& x) {
  const int apex = static_cast<int>(mesh_.vertex_count());
  mesh_.position.push_back(x);
  const bool crosses = would_cross(old, apex);
  mesh_.position.pop_back();
  return crosses;
}

/// The same of those that join a vertex.
bool RemeshPass::would_cross(std::span<const int> old, int apex) const {
  const auto is_old = [&](int t) { return std::ranges::count(old, t) > 0; };
  std::vector<int> around(old.begin(), old.end());
  for (int ring = 0; ring < kCrossingRings; ++ring) {
    for (std::size_t i = 0, n = around.size(); i < n; ++i)
      for (const int v : mesh_.triangles[around[i]])
        edits_.for_each_out(v, [&](int out) { around.push_back(out / 3); });
    std::ranges::sort(around);
    around.erase(std::unique(around.begin(), around.end()), around.end());
  }
  std::vector<Triangle> triangles;
  for (const int t : around)
    if (!is_old(t)) triangles.push_back(mesh_.triangles[t]);
  const int first_new = static_cast<int>(triangles.size());
  for (const int t : old)
    for (int h = 3 * t; h < 3 * t + 3; ++h)
      if (const int u = edits_.origin(h), v = edits_.end(h);
          !is_old(edits_.twin(h) / 3) && u != apex && v != apex)
        triangles.push_back({u, v, apex});
  const std::vector<int> crossing = intersecting_triangles(mesh_.position, triangles);
  return !crossing.empty() && crossing.back() >= first_new;
}

std::vector<int> RemeshPass::fan_triangles(int v) const {
  std::vector<int> fan;
  edits_.for_each_out(v, [&](int out) { fan.push_back(out / 3); });
  return fan;
}

Worst RemeshPass::fan(int v) const {
  return fan_moved(v, at(v), s_.normal_[v]);
}

/// The triangles of v if it were at x, where the normal is n.
Worst RemeshPass::fan_moved(int v, const Vec3& x, const Vec3& n) const {
  Worst worst;
  edits_.for_each_out(v, [&](int out) { add_to(worst, x, n, edits_.end(out), edits_.apex(out)); });
  return worst;
}

/// Lawson's flips; the smallest angle grows with each, so that they end.
void RemeshPass::flip_towards_delaunay() {
  s_.flag_.resize(edits_.half_edges());
  parallel_for(s_.flag_.size(), [&](std::size_t i) {
    const int h = static_cast<int>(i);
    s_.flag_[h] = !edits_.is_removed(h) && h < edits_.twin(h) && !is_delaunay(h);
  });
  s_.pending_.clear();
  for (int h = edits_.half_edges() - 1; h >= 0; --h)
    if (s_.flag_[h]) s_.pending_.push_back(h);
  while (!s_.pending_.empty()) {
    const int h = s_.pending_.back();
    s_.pending_.pop_back();
    const int right = edits_.twin(h) / 3, left = h / 3;
    if (!flip(h)) continue;
    for (const int around : {3 * left, 3 * left + 2, 3 * right, 3 * right + 2}) s_.pending_.push_back(around);
  }
}

bool RemeshPass::is_delaunay(int h) const {
  const int u = edits_.origin(h), v = edits_.end(h), a = edits_.apex(h), b = edits_.apex(edits_.twin(h));
  return kappaflow::is_delaunay(at(u), at(v), at(a), at(b));
}

bool RemeshPass::flip(int h) {
  if (is_delaunay(h)) return false;
  const int u = edits_.origin(h), v = edits_.end(h), a = edits_.apex(h), b = edits_.apex(edits_.twin(h));
  Worst before, after;
  add_to(before, u, v, a);
  add_to(before, v, u, b);
  add_to(after, u, b, a);
  add_to(after, v, a, b);
  const Vec3 facing_before = normal(u, v, a) + normal(v, u, b);
  if (!(after.sharpness < before.sharpness) || !after.faces_fairly(before) ||
      facing(at(u), at(b), at(a), facing_before) < kSteep ||
      facing(at(v), at(a), at(b), facing_before) < kSteep || is_off_surface({u, b, a}) ||
      is_off_surface({v, a, b}) || !guard_.allows(at(u), at(v), at(a), at(b)) ||
      (!after.faces_well(before) && would_cross(std::array{h / 3, edits_.twin(h) / 3}, a)) || !edits_.flip(h))
    return false;
  ++counts.flips;
  return true;
}

void RemeshPass::finish() {
  edits_.finish();
  edits_.history().keep(facts_.gradient);
  edits_.history().keep(facts_.mobility);
}

RemeshCounts Remesher::remesh(const Field& field, const RemeshOptions& options,
                              const ProjectionOptions& projection, const VertexRings& rings,
                              TriangleMesh& mesh, VertexFacts facts, const LatticeGuard& guard) {
  edits_.start(mesh);
  RemeshPass pass(field, options, projection, guard, mesh, facts, *this);
  pass.set_targets(rings);
  pass.split_long_edges();
  pass.refine_off_surface();
  pass.collapse_short_edges();
  for (int round = 0; round < RemeshPass::kRounds; ++round) {
    pass.flip_towards_delaunay();
    if (!pass.repair_sharp_triangles()) break;
  }
  pass.finish();
  return pass.counts;
}

}  // namespace kappaflow
