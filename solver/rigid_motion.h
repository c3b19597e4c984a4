// Rigid motions about a point, loads about a point, and symmetric matrices from the former to the latter.
#pragma once

#include "core/types.h"

namespace kappaflow {

/// A rigid motion about a point: velocity [m/s], 0, angular velocity [rad/s], 0. Or a load about it: force,
/// 0, torque, 0.
using RigidVector = Eigen::Matrix<float, 8, 1>;
/// From rigid motions, without their zeros, to loads.
using RigidMatrix = Eigen::Matrix<float, 8, 6>;

namespace rigid {

/// The fourth components are not read.
inline Vec4f cross(const Vec4f& a, const Vec4f& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0};
}

/// Velocity at the point that is `arm` away.
inline Vec4f velocity(const RigidVector& motion, const Vec4f& arm) {
  return motion.head<4>() + cross(motion.tail<4>(), arm);
}

/// The load of a force that acts `arm` away.
inline RigidVector load(const Vec4f& force, const Vec4f& arm) {
  RigidVector result;
  result.head<4>() = force;
  result.tail<4>() = cross(arm, force);
  return result;
}

/// The same motion about the point that is `arm` away.
inline RigidVector motion_about(const RigidVector& motion, const Vec4f& arm) {
  RigidVector result = motion;
  result.head<4>() += cross(motion.tail<4>(), arm);
  return result;
}

/// A load about the point that is `arm` away, about this one.
inline RigidVector load_from(const RigidVector& load, const Vec4f& arm) {
  RigidVector result = load;
  result.tail<4>() += cross(arm, load.head<4>());
  return result;
}

/// Where the vector has what the matrix's column multiplies.
constexpr int row_of(int column) {
  return column < 3 ? column : column + 1;
}

inline RigidVector product(const RigidMatrix& matrix, const RigidVector& motion) {
  RigidVector sum = matrix.col(0) * motion[0];
  for (int c = 1; c < 6; ++c) sum += matrix.col(c) * motion[row_of(c)];
  return sum;
}

/// A matrix about the point that is `arm` away, about this one.
inline RigidMatrix matrix_from(const RigidMatrix& matrix, const Vec4f& arm) {
  RigidMatrix result;
  for (int c = 0; c < 6; ++c)
    result.col(c) = load_from(product(matrix, motion_about(RigidVector::Unit(row_of(c)), arm)), arm);
  return result;
}

/// Without the rows of zeros.
inline Eigen::Matrix<double, 6, 6> squared(const RigidMatrix& matrix) {
  Eigen::Matrix<double, 6, 6> result;
  result << matrix.topRows<3>().cast<double>(), matrix.middleRows<3>(4).cast<double>();
  return result;
}

}  // namespace rigid
}  // namespace kappaflow
