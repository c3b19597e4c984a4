// Vector types, and the one place that says which precision is used where.
//
// The SPH particles live in single precision: their equations need about five digits, and the hot loops are
// bound by memory. Everything about the surface is double: the curvature rates of Eqs. 7-8 contain third
// derivatives of f, which cancel heavily.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace kappaflow {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

/// A 3-vector of an SPH particle, padded to one 16-byte SIMD register; the fourth component is 0 unless
/// stated.
using Vec4f = Eigen::Vector4f;

/// Three vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<int, 3>;

/// An indexed triangle surface without attributes, e.g. a solid boundary [m]. Closed surfaces are oriented
/// outward.
struct TriangleSurface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

// The layouts of what stands in public headers do not depend on -march: programs may be compiled with another
// one than the library, or with none. Eigen aligns a fixed-size type of a multiple of 16 bytes to as much as
// the processor's registers have (Matrix2d to 16 or 32), so none that is larger than 16 bytes may stand
// there.
static_assert(alignof(Vec3) == alignof(double) && sizeof(Vec3) == 3 * sizeof(double));
static_assert(alignof(Mat3) == alignof(double) && sizeof(Mat3) == 9 * sizeof(double));
static_assert(alignof(Vec2) == 16 && alignof(Vec4f) == 16);

}  // namespace kappaflow
