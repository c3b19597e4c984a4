// Kernels that need not be round: what a field of Eq. 12 with ellipsoids is made of.
#pragma once

#include <array>
#include <vector>

#include "core/types.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {

/// A symmetric matrix by symmetric_place(): xx xy xz yy yz zz.
using SymmetricMatrix = std::array<double, 6>;

inline SymmetricMatrix symmetric(const Mat3& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

inline Mat3 full(const SymmetricMatrix& m) {
  Mat3 result;
  result << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  return result;
}

/// Kernels w_i (1 - s)^3, s = (x - c_i) . M_i (x - c_i), at one instant: an ellipsoid supports each. One
/// entry a kernel in every array.
struct FieldKernels {
  std::vector<Vec3> center;                 ///< c_i [m]
  std::vector<Vec3> velocity;               ///< dc_i/dt [m/s]
  std::vector<SymmetricMatrix> shape;       ///< M_i, positive definite [1/m2]
  std::vector<SymmetricMatrix> shape_rate;  ///< dM_i/dt [1/(m2 s)]
  std::vector<double> weight;               ///< w_i [-]
  std::vector<double> weight_rate;          ///< dw_i/dt [1/s]

  std::size_t size() const { return center.size(); }
};

}  // namespace kappaflow
