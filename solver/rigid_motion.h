// Rigid motions about a point, loads about a point, and symmetric matrices from the former to the latter.
#pragma once

#include <Eigen/Geometry>
#include <array>

#include "core/types.h"
#include "solver/lanes.h"

namespace kappaflow {

/// xx, yy, zz, yz, xz, xy
using SymmetricMatrix = std::array<float, 6>;

/// A rigid motion about a point: velocity [m/s] and angular velocity [rad/s]. Or a load about it: force and
/// torque. Both padded.
struct RigidVector {
  Vec4f linear = Vec4f::Zero(), angular = Vec4f::Zero();

  void operator+=(const RigidVector& other) {
    linear += other.linear;
    angular += other.angular;
  }
  void operator-=(const RigidVector& other) {
    linear -= other.linear;
    angular -= other.angular;
  }
  friend RigidVector operator-(RigidVector a, const RigidVector& b) {
    a -= b;
    return a;
  }
};

/// From rigid motions to loads, symmetric: 21 numbers. T is float, or Wide: eight matrices.
template <class T>
struct RigidMatrixOf {
  std::array<T, 6> force{};    ///< from velocity to force, as SymmetricMatrix
  std::array<T, 9> torque{};   ///< from velocity to torque, by rows; its transpose: from angular velocity to
                               ///< force
  std::array<T, 6> turning{};  ///< from angular velocity to torque

  void operator+=(const RigidMatrixOf& other) {
    for (std::size_t k = 0; k < 6; ++k) force[k] += other.force[k];
    for (std::size_t k = 0; k < 9; ++k) torque[k] += other.torque[k];
    for (std::size_t k = 0; k < 6; ++k) turning[k] += other.turning[k];
  }
};
using RigidMatrix = RigidMatrixOf<float>;

namespace rigid {

using Vector6 = Eigen::Matrix<double, 6, 1>;  ///< a motion or a load: what is linear, then what is angular
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// From motions about a point to the velocity at the point that is `arm` away.
inline Eigen::Matrix<double, 3, 6> velocities_at(const Vec3& arm) {
  Eigen::Matrix<double, 3, 6> result;
  result << 1, 0, 0, 0, arm.z(), -arm.y(),  //
      0, 1, 0, -arm.z(), 0, arm.x(),        //
      0, 0, 1, arm.y(), -arm.x(), 0;
  return result;
}

/// The load of a force at the point that is `arm` away.
inline Vector6 load_of(const Vec3& force, const Vec3& arm) {
  Vector6 result;
  result.head<3>() = force;
  result.tail<3>() = arm.cross(force);
  return result;
}

/// The velocity at the point that is `arm` away.
inline Vec3 velocity_at(const Vector6& motion, const Vec3& arm) {
  return motion.head<3>() + motion.tail<3>().cross(arm);
}

/// Of a symmetric matrix of six numbers and a padded vector.
inline Vec4f product(const float* six, const Vec4f& v) {
  const Vec4f diagonal = Eigen::Map<const Vec4f>(six), zz_yz_xz_xy = Eigen::Map<const Vec4f>(six + 2);
  return diagonal.cwiseProduct(v) + shuffled<3, 1, 2, 0>(zz_yz_xz_xy).cwiseProduct(shuffled<1, 2, 0, 3>(v)) +
         shuffled<2, 3, 1, 0>(zz_yz_xz_xy).cwiseProduct(shuffled<2, 0, 1, 3>(v));
}

/// The same motion about the point that is `arm` away.
inline RigidVector motion_about(const RigidVector& motion, const Vec4f& arm) {
  return {motion.linear + cross(motion.angular, arm), motion.angular};
}

/// A load about the point that is `arm` away, about this one.
inline RigidVector load_from(const RigidVector& load, const Vec4f& arm) {
  return {load.linear, load.angular + cross(arm, load.linear)};
}

[[gnu::always_inline]] inline RigidVector product(const RigidMatrix& matrix, const RigidVector& motion) {
  static_assert(sizeof(RigidMatrix) == 21 * sizeof(float));
  const float *force = reinterpret_cast<const float*>(&matrix), *torque = force + 6, *turning = force + 15;
  const auto four = [](const float* at) -> Vec4f { return Eigen::Map<const Vec4f>(at); };
  const auto& [v, w] = motion;
  const Vec4f transposed = four(torque) * w[0] + four(torque + 3) * w[1] + four(torque + 6) * w[2];
  const Vec4f last = four(torque + 5);  // from 5 on: its second, third and fourth are the last row
  const Vec4f columns = shuffled<0, 3, 5, 5>(four(torque), last) * v[0] +
                        shuffled<0, 3, 6, 6>(four(torque + 1), last) * v[1] +
                        shuffled<0, 3, 7, 7>(four(torque + 2), last) * v[2];
  return {product(force, v) + without_fourth(transposed), without_fourth(columns) + product(turning, w)};
}

/// Whether it is not zero: a resistance has resisting force on some axis.
inline bool resists(const RigidMatrix& matrix) {
  return matrix.force[0] + matrix.force[1] + matrix.force[2] > 0;
}

/// [arm] matrix, by rows: arm x its columns.
template <class T>
std::array<T, 9> crossed(const Eigen::Vector3f& arm, const std::array<T, 6>& matrix) {
  const float x = arm[0], y = arm[1], z = arm[2];
  const auto& [xx, yy, zz, yz, xz, xy] = matrix;
  return {T(y * xz - z * xy), T(y * yz - z * yy), T(y * zz - z * yz),  //
          T(z * xx - x * xz), T(z * xy - x * yz), T(z * xz - x * zz),  //
          T(x * xy - y * xx), T(x * yy - y * xy), T(x * yz - y * xz)};
}

/// [arm] t^T, t by rows, where it is symmetric.
template <class T>
std::array<T, 6> crossed(const Eigen::Vector3f& arm, const std::array<T, 9>& t) {
  const float x = arm[0], y = arm[1], z = arm[2];
  return {T(y * t[2] - z * t[1]), T(z * t[3] - x * t[5]), T(x * t[7] - y * t[6]),
          T(z * t[6] - x * t[8]), T(y * t[8] - z * t[7]), T(y * t[5] - z * t[4])};
}

/// The matrix of a resistance to the velocity at the point that is `arm` away.
template <class T>
RigidMatrixOf<T> matrix_at(const std::array<T, 6>& resistance, const Eigen::Vector3f& arm) {
  const std::array<T, 9> torque = crossed(arm, resistance);
  return {resistance, torque, crossed(arm, torque)};
}

/// A matrix about the point that is `arm` away, about this one.
inline RigidMatrix matrix_from(const RigidMatrix& matrix, const Eigen::Vector3f& arm) {
  const float x = arm[0], y = arm[1], z = arm[2];
  const auto& b = matrix.torque;
  RigidMatrix result = matrix_at(matrix.force, arm);
  for (std::size_t k = 0; k < 9; ++k) result.torque[k] += b[k];
  // turning + [arm] result.torque^T - torque [arm]
  const std::array<float, 6> left = crossed(arm, result.torque);
  const std::array<float, 6> right{b[1] * z - b[2] * y, b[5] * x - b[3] * z, b[6] * y - b[7] * x,
                                   b[3] * y - b[4] * x, b[0] * y - b[1] * x, b[2] * x - b[0] * z};
  for (std::size_t k = 0; k < 6; ++k) result.turning[k] = matrix.turning[k] + (left[k] - right[k]);
  return result;
}

/// One of the eight.
inline RigidMatrix matrix_in(const RigidMatrixOf<Wide>& matrices, int lane) {
  RigidMatrix result;
  for (std::size_t k = 0; k < 6; ++k) result.force[k] = matrices.force[k][lane];
  for (std::size_t k = 0; k < 9; ++k) result.torque[k] = matrices.torque[k][lane];
  for (std::size_t k = 0; k < 6; ++k) result.turning[k] = matrices.turning[k][lane];
  return result;
}

/// All of it in double precision.
inline Eigen::Matrix<double, 6, 6> squared(const RigidMatrix& matrix) {
  const auto symmetric = [](const SymmetricMatrix& m) {
    Eigen::Matrix3f result;
    result << m[0], m[5], m[4], m[5], m[1], m[3], m[4], m[3], m[2];
    return result.cast<double>().eval();
  };
  const auto torque =
      Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(matrix.torque.data()).cast<double>();
  Eigen::Matrix<double, 6, 6> result;
  result << symmetric(matrix.force), torque.transpose(), torque, symmetric(matrix.turning);
  return result;
}

/// The other way, from the lower triangle.
inline RigidMatrix packed(const Eigen::Matrix<double, 6, 6>& matrix) {
  const Eigen::Matrix<float, 6, 6> m = matrix.cast<float>();
  return {{m(0, 0), m(1, 1), m(2, 2), m(2, 1), m(2, 0), m(1, 0)},
          {m(3, 0), m(3, 1), m(3, 2), m(4, 0), m(4, 1), m(4, 2), m(5, 0), m(5, 1), m(5, 2)},
          {m(3, 3), m(4, 4), m(5, 5), m(5, 4), m(5, 3), m(4, 3)}};
}

}  // namespace rigid
}  // namespace kappaflow
