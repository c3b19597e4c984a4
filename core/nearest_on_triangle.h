// The point of one triangle that is nearest to a given one.
#pragma once

#include <array>

#include "core/types.h"

namespace kappaflow {

/// A point of a triangle.
struct NearestOnTriangle {
  /// The parts of a triangle that can be nearest; edge k runs from corner k to corner k + 1.
  enum Feature { corner_0, corner_1, corner_2, edge_0, edge_1, edge_2, face };
  Vec3 point;  ///< [m]
  Feature feature;
};

/// The point of the triangle that is nearest to x [m], and in which part of it. (Ericson, "Real-Time
/// Collision Detection", 2005, section 5.1.5.)
NearestOnTriangle nearest_on_triangle(const std::array<Vec3, 3>& triangle, const Vec3& x);

/// The weights of the corners, sum 1, of which the point x of the triangle's plane is the mean. The corners'
/// mean where the triangle has no area.
Vec3 corner_weights(const std::array<Vec3, 3>& triangle, const Vec3& x);

}  // namespace kappaflow
