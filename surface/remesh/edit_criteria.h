// By what the passes of a remeshing judge an edit before they make it. Private to this folder.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/remesh_state.h"

namespace kappaflow {

inline constexpr double kLong = 1.5;     // an edge's length over the one aimed at from which it is split
inline constexpr double kSteep = 0.3;    // least cosine by which an edit may turn a triangle
inline constexpr double kSharp = 0.927;  // cosine of the smallest angle that needs no repair: 22 degrees

/// Cosine of the smallest angle: 1/2 for an equilateral triangle, 1 for a degenerate one.
inline double sharpness(const Vec3& a, const Vec3& b, const Vec3& c) {
  double s = (b - c).squaredNorm(), l = (c - a).squaredNorm(), m = (a - b).squaredNorm();
  if (s > l) std::swap(s, l);
  if (s > m) std::swap(s, m);
  const double product = std::sqrt(l * m);
  return product > 0 ? (l + m - s) / (2 * product) : 1;
}

/// The worst of a group of triangles in both respects.
struct WorstOf {
  static constexpr double kFacing = 0.9;    ///< cosine to the sum of the corners' normals that is always good
  static constexpr double kSliver = 0.966;  ///< cosine of the smallest angle: 15 degrees
  static constexpr double kAllowance = 0.15;  ///< of facing, where a sliver goes

  double sharpness = 0;  ///< largest
  double facing = 1;     ///< smallest cosine to the sum of the field's normals at the corners

  void add(double sharp, double face) {
    sharpness = std::max(sharpness, sharp);
    facing = std::min(facing, face);
  }
  bool faces_well(const WorstOf& before) const {
    return facing > 0 && facing >= std::min(kFacing, before.facing);
  }
  /// Enough for an edit that removes a sliver, if it makes nothing cross.
  bool faces_fairly(const WorstOf& before) const {
    const double allowance = before.sharpness > kSliver ? kAllowance : 0;
    return facing > 0 && facing >= std::min(kFacing, before.facing) - allowance;
  }
};

/// A triangle with its first corner at x, where the normal is n.
void add_to(WorstOf& worst, const RemeshState& state, const Vec3& x, const Vec3& n, int b, int c);
void add_to(WorstOf& worst, const RemeshState& state, int a, int b, int c);
/// The triangles around v.
WorstOf fan(const RemeshState& state, int v);
/// The same if v were at x, where the normal is n.
WorstOf fan_moved(const RemeshState& state, int v, const Vec3& x, const Vec3& n);
std::vector<int> fan_triangles(const RemeshState& state, int v);
/// Unit normal of triangle (a, b, c).
Vec3 triangle_normal(const RemeshState& state, int a, int b, int c);

/// Whether a triangle with this centroid is further from f = 0 than a chord may be.
bool is_off(const RemeshSetting& setting, const Vec3& centroid);
/// The same of a triangle; but the field is not asked where the surface is flat, and where the normals at the
/// corners hardly turn along so short a triangle that faces along them.
bool is_off_surface(const RemeshSetting& setting, const RemeshState& state, const Triangle& triangle);

/// How many edges it is from a vertex whose triangles give way to those whose triangles would_cross() reads;
/// from the corners of the triangles it is one less: so many rings and one more.
inline constexpr int kCrossingReach = 2;

/// Whether the triangles that join vertex apex with the edges around the old ones pass through others in the
/// two rings around these.
bool would_cross(const RemeshState& state, std::span<const int> old, int apex);
/// The same of those that join a place.
bool would_cross(const RemeshState& state, std::span<const int> old, const Vec3& x);

}  // namespace kappaflow
