#include "surface/tracker/remeshing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "core/parallel.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

constexpr double kLong = 1.5, kShort = 0.6;  // in lengths aimed at: half of a long edge is not short
constexpr double kChord =
    0.15;                       // distance of a triangle from f = 0 that calls for smaller ones [edge_length]
constexpr double kSteep = 0.3;  // least cosine by which an edit may turn a triangle
constexpr double kFlatShare = 0.5;  // of an edge's length that counts where the normals at its ends agree
constexpr double kBend = 0.4;   // length times turn of the normal whose chord is surely nearer [edge_length]
constexpr double kBent = 0.99;  // length aimed at [edge_length] above which the surface counts as flat
constexpr double kGrading = 0.4;   // largest change of the length aimed at per length along the surface
constexpr int kGradingPasses = 3;  // more follow in the next steps
constexpr double kSharp = 0.927;   // cosine of the smallest angle that needs no repair: 22 degrees
constexpr double kFacing = 0.9;    // cosine between a triangle and its corners' normals that is always good
constexpr double kGain = 1e-3;     // least improvement of that cosine which is worth an edit
constexpr double kFlipMargin = 1e-9;  // of the sum of cotangents
constexpr int kRounds = 3;            // of splits, and of flips and repairs

double cotangent(const Vec3& apex, const Vec3& a, const Vec3& b) {
  return (a - apex).dot(b - apex) / (a - apex).cross(b - apex).norm();
}

/// Cosine of the smallest angle: 1/2 for an equilateral triangle, 1 for a degenerate one.
double sharpness(const Vec3& a, const Vec3& b, const Vec3& c) {
  double s = (b - c).squaredNorm(), l = (c - a).squaredNorm(), m = (a - b).squaredNorm();
  if (s > l) std::swap(s, l);
  if (s > m) std::swap(s, m);
  const double product = std::sqrt(l * m);
  return product > 0 ? (l + m - s) / (2 * product) : 1;
}

/// The worst triangle of a group.
struct Worst {
  double sharpness = 0, facing = 1;
  void add(double sharp, double face) {
    sharpness = std::max(sharpness, sharp);
    facing = std::min(facing, face);
  }
  bool faces_well(const Worst& before) const {
    return facing > 0 && facing >= std::min(kFacing, before.facing);
  }
};

}  // namespace

/// One remesh(): what its edits work on.
class RemeshPass {
 public:
  RemeshPass(const Field& field, const RemeshOptions& options, const ProjectionOptions& projection,
             TriangleMesh& mesh, VertexFacts facts, Remesher& scratch)
      : field_(field),
        options_(options),
        projection_(projection),
        mesh_(mesh),
        facts_(facts),
        s_(scratch),
        edits_(s_.edits_) {}

  void set_targets(const VertexRings& rings);
  void split_long_edges();
  void refine_off_surface();
  void collapse_short_edges();
  void flip_towards_delaunay();
  bool repair_sharp_triangles();
  void finish();

  RemeshCounts counts;

 private:
  const Vec3& at(int v) const { return mesh_.position[v]; }
  Vec3 normal(int a, int b, int c) const { return (at(b) - at(a)).cross(at(c) - at(a)).normalized(); }
  double aimed_at(int u, int v) const { return 0.5 * (s_.target_[u] + s_.target_[v]); }
  void add_to(Worst& worst, int a, int b, int c) const { add_to(worst, at(a), s_.normal_[a], b, c); }
  /// A triangle with its first corner at x, where the normal is n.
  void add_to(Worst& worst, const Vec3& x, const Vec3& n, int b, int c) const {
    worst.add(sharpness(x, at(b), at(c)), facing(x, at(b), at(c), n + s_.normal_[b] + s_.normal_[c]));
  }
  Worst fan(int v) const;
  Worst fan_moved(int v, const Vec3& x, const Vec3& n) const;
  double normal_turn(int u, int v) const;
  template <class Choose>
  void collect_edges(const Choose& choose);
  bool is_off_surface(const Triangle& triangle) const;
  int most_bent_edge(int triangle) const;
  void project_midpoints();
  void split(int h, const Projected& midpoint);
  void refine(int triangle);
  bool collapse_either_way(int h, bool repair);
  bool may_collapse(int h, bool repair);
  bool leaves_surface(int h) const;
  bool is_delaunay(int h) const;
  bool flip(int h);
  bool is_sharp(int triangle) const;
  bool replace_a_corner(int triangle);
  std::optional<Vec3> better_place(int v, double& sharp) const;
  VertexBlend blend_around(int v, const Vec3& x) const;
  bool replace(int v, const Vec3& x);
  bool keeps_facing(int u, int v, int a, const Vec3& x) const;
  void add_facts(const Projected& projected, const VertexBlend& from);

  const Field& field_;
  const RemeshOptions& options_;
  const ProjectionOptions& projection_;
  TriangleMesh& mesh_;
  VertexFacts facts_;
  Remesher& s_;
  EdgeEdits& edits_;
};

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
  if (length <= 2 * kShort * options_.finest * options_.edge_length) return;
  const auto nearby = [&](const Vec3& x) {
    const Projected projected = project(field_, x, projection_);
    return projected.converged && (projected.position - x).norm() < length ? std::optional(projected)
                                                                           : std::nullopt;
  };
  if (const auto middle = nearby(0.5 * (at(u) + at(v)));
      middle && keeps_facing(u, v, a, middle->position) &&
      keeps_facing(v, u, edits_.apex(edits_.twin(h)), middle->position)) {
    edits_.split(h, 0.5, middle->position);
    add_facts(*middle, {{u, v, v}, {0.5, 0.5, 0}});
  } else if (const auto centre = nearby((at(u) + at(v) + at(a)) / 3);
             centre && keeps_facing(u, v, a, centre->position) &&
             facing(at(u), at(v), centre->position, normal(u, v, a)) >= kSteep) {
    const VertexBlend blend{{u, v, a}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};
    edits_.split(triangle, blend, centre->position);
    add_facts(*centre, blend);
  } else {
    return;
  }
  ++counts.splits;
}

/// Whether triangle (u, v, a) hardly turns where x is put between u and v. The normals at the corners do not
/// tell where it cuts through a tip or a rim: they may point in opposite directions.
bool RemeshPass::keeps_facing(int u, int v, int a, const Vec3& x) const {
  const Vec3 before = normal(u, v, a);
  return facing(at(u), x, at(a), before) >= kSteep && facing(x, at(v), at(a), before) >= kSteep;
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
  if (bend < kBend * unit && facing(at(a), at(b), at(c), normals) > kFacing) return false;
  const ValueAndGradient centroid = field_.value_and_gradient((at(a) + at(b) + at(c)) / 3);
  return std::abs(centroid.f) > kChord * unit * centroid.g.norm();
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
  if (!after.faces_well(before)) return;
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

/// repair: whether the triangles must become better; else they must not become bad.
bool RemeshPass::may_collapse(int h, bool repair) {
  const int u = edits_.origin(h), v = edits_.end(h), left = h / 3, right = edits_.twin(h) / 3;
  Worst before = fan(u), after;
  bool refused = false;
  edits_.for_each_out(u, [&](int out) {
    const int b = edits_.end(out), c = edits_.apex(out);
    refused |= b != v && (at(b) - at(v)).norm() > kLong * aimed_at(b, v);
    if (out / 3 == left || out / 3 == right) return;
    add_to(after, v, b, c);
    refused |= facing(at(v), at(b), at(c), normal(u, b, c)) < kSteep;
  });
  const double limit = repair ? before.sharpness - kGain : std::max(kSharp, before.sharpness);
  return !refused && after.sharpness <= limit && after.faces_well(before) && edits_.can_collapse(h) &&
         !leaves_surface(h);
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

/// Not where the opposite angles sum to more than pi.
bool RemeshPass::is_delaunay(int h) const {
  const int u = edits_.origin(h), v = edits_.end(h), a = edits_.apex(h), b = edits_.apex(edits_.twin(h));
  return !(cotangent(at(a), at(u), at(v)) + cotangent(at(b), at(u), at(v)) < -kFlipMargin);
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
  if (!(after.sharpness < before.sharpness) || !after.faces_well(before) ||
      facing(at(u), at(b), at(a), facing_before) < kSteep ||
      facing(at(v), at(a), at(b), facing_before) < kSteep || is_off_surface({u, b, a}) ||
      is_off_surface({v, a, b}) || !edits_.flip(h))
    return false;
  ++counts.flips;
  return true;
}

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
    if (!(after.sharpness < sharp) || !after.faces_well(before)) continue;
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

bool RemeshPass::replace(int v, const Vec3& x) {
  const Projected projected = project(field_, x, projection_);
  if (!projected.converged) return false;
  const Worst before = fan(v), after = fan_moved(v, projected.position, -projected.gradient.normalized());
  if (!(after.sharpness <= before.sharpness - kGain) || !after.faces_well(before)) return false;
  const VertexBlend from = blend_around(v, projected.position);
  edits_.replace(v, from, projected.position);
  add_facts(projected, from);
  ++counts.replaced;
  return true;
}

void RemeshPass::finish() {
  edits_.finish();
  edits_.history().keep(facts_.gradient);
  edits_.history().keep(facts_.mobility);
}

RemeshCounts Remesher::remesh(const Field& field, const RemeshOptions& options,
                              const ProjectionOptions& projection, const VertexRings& rings,
                              TriangleMesh& mesh, VertexFacts facts) {
  edits_.start(mesh);
  RemeshPass pass(field, options, projection, mesh, facts, *this);
  pass.set_targets(rings);
  pass.split_long_edges();
  pass.refine_off_surface();
  pass.collapse_short_edges();
  for (int round = 0; round < kRounds; ++round) {
    pass.flip_towards_delaunay();
    if (!pass.repair_sharp_triangles()) break;
  }
  pass.finish();
  return pass.counts;
}

}  // namespace kappaflow
