// One remeshing at work. Private to the remesher's sources.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/remeshing.h"

namespace kappaflow {

/// Cosine of the smallest angle: 1/2 for an equilateral triangle, 1 for a degenerate one.
inline double sharpness(const Vec3& a, const Vec3& b, const Vec3& c) {
  double s = (b - c).squaredNorm(), l = (c - a).squaredNorm(), m = (a - b).squaredNorm();
  if (s > l) std::swap(s, l);
  if (s > m) std::swap(s, m);
  const double product = std::sqrt(l * m);
  return product > 0 ? (l + m - s) / (2 * product) : 1;
}

/// The worst triangle of a group.
struct Worst {
  static constexpr double kFacing = 0.9;    ///< cosine to the sum of the corners' normals that is always good
  static constexpr double kSliver = 0.966;  ///< cosine of the smallest angle: 15 degrees
  static constexpr double kAllowance = 0.15;  ///< of facing, where a sliver goes

  double sharpness = 0, facing = 1;
  void add(double sharp, double face) {
    sharpness = std::max(sharpness, sharp);
    facing = std::min(facing, face);
  }
  bool faces_well(const Worst& before) const {
    return facing > 0 && facing >= std::min(kFacing, before.facing);
  }
  /// Enough for an edit that mends a sliver, if it makes nothing cross.
  bool faces_fairly(const Worst& before) const {
    const double allowance = before.sharpness > kSliver ? kAllowance : 0;
    return facing > 0 && facing >= std::min(kFacing, before.facing) - allowance;
  }
};

/// One remesh(): what its edits work on.
class RemeshPass {
 public:
  RemeshPass(const Field& field, const RemeshOptions& options, const ProjectionOptions& projection,
             const LatticeGuard& guard, TriangleMesh& mesh, VertexFacts facts, Remesher& scratch)
      : field_(field),
        options_(options),
        projection_(projection),
        guard_(guard),
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

  static constexpr int kRounds = 3;  ///< of refinement, and of flips and repairs

 private:
  static constexpr double kLong = 1.5, kShort = 0.6;  // in lengths aimed at: half of a long edge is not short
  static constexpr double kTooLong = 2;               // even where a sliver goes for it
  static constexpr double kSteep = 0.3;               // least cosine by which an edit may turn a triangle
  static constexpr double kSharp = 0.927;  // cosine of the smallest angle that needs no repair: 22 degrees
  static constexpr double kGain = 1e-3;    // least improvement of that cosine which is worth an edit

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
  bool is_off(const Vec3& centroid) const;
  bool leaves_surface(int v, const Vec3& x) const;
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
  bool may_join(std::span<const int> old, const Vec3& x);
  bool would_cross(std::span<const int> old, const Vec3& x);
  bool would_cross(std::span<const int> old, int apex) const;
  std::vector<int> fan_triangles(int v) const;
  bool spoils_lattice(int v, const Vec3& x) const;
  void add_facts(const Projected& projected, const VertexBlend& from);

  const Field& field_;
  const RemeshOptions& options_;
  const ProjectionOptions& projection_;
  const LatticeGuard& guard_;
  TriangleMesh& mesh_;
  VertexFacts facts_;
  Remesher& s_;
  EdgeEdits& edits_;
};

}  // namespace kappaflow
