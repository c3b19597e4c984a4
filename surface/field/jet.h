// The jet of the implicit function: f with all the derivatives that the velocity equations use.
#pragma once

#include "core/types.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {

/// The ten distinct third derivatives of a scalar.
struct ThirdDerivatives {
  double xxx = 0, xxy = 0, xxz = 0, xyy = 0, xyz = 0, xzz = 0, yyy = 0, yyz = 0, yzz = 0, zzz = 0;

  /// f_abc.
  constexpr double at(int a, int b, int c) const {
    using T = ThirdDerivatives;
    constexpr double T::*kPlaces[] = {&T::xxx, &T::xxy, &T::xxz, &T::xyy, &T::xyz,
                                      &T::xzz, &T::yyy, &T::yyz, &T::yzz, &T::zzz};
    return this->*kPlaces[symmetric_place(a, b, c)];
  }
  /// The symmetric matrix sum_c f_abc v_c: the rate of change of the Hessian along v.
  Mat3 contract(const Vec3& v) const {
    Mat3 m;
    m(0, 0) = xxx * v[0] + xxy * v[1] + xxz * v[2];
    m(0, 1) = m(1, 0) = xxy * v[0] + xyy * v[1] + xyz * v[2];
    m(0, 2) = m(2, 0) = xxz * v[0] + xyz * v[1] + xzz * v[2];
    m(1, 1) = xyy * v[0] + yyy * v[1] + yyz * v[2];
    m(1, 2) = m(2, 1) = xyz * v[0] + yyz * v[1] + yzz * v[2];
    m(2, 2) = xzz * v[0] + yzz * v[1] + zzz * v[2];
    return m;
  }
};

/// f and its derivatives at one point and time. f > 0 inside; grad f points inward; outward normal n =
/// -g/|g|.
struct Jet {
  double f = 0;             ///< value, threshold subtracted [-]
  Vec3 g = Vec3::Zero();    ///< gradient [1/m]
  Mat3 A = Mat3::Zero();    ///< Hessian [1/m2]
  ThirdDerivatives C;       ///< third derivatives [1/m3]
  double f_t = 0;           ///< partial time derivative at fixed x [1/s]
  Vec3 g_t = Vec3::Zero();  ///< of the gradient [1/(m s)]
  Mat3 A_t = Mat3::Zero();  ///< of the Hessian [1/(m2 s)]
  double length_scale =
      0;  ///< sigma, averaged with weights w phi over what is in reach [m]; 0: nothing in reach
  double fastest_in_reach = 0;  ///< largest speed of what makes the field here [m/s]; bounds velocities
};

/// How far f is from being carried by its material where that is strained. If the material moves with the
/// velocity u(y) and the symmetric velocity gradient E (rotations do not matter), then near x
///   f_t + g . u = R(E),   R linear in E.
/// Zero where the material carries the level sets. Particles carry round kernels that do not take part in the
/// strain, hence R != 0 for Eq. 12. Each matrix M below is symmetric and stands for M : E = sum_ab M_ab E_ab.
struct StrainResponse {
  Mat3 f = Mat3::Zero();                                            ///< of R [-]
  std::array<Mat3, 3> g{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};  ///< of its gradient x, y, z [1/m]
  std::array<Mat3, 6> A{Mat3::Zero(), Mat3::Zero(), Mat3::Zero(),
                        Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};  ///< Hessian xx, xy, xz, yy, yz, zz [1/m2]
};

/// f and its gradient at one point, for projection.
struct ValueAndGradient {
  double f = 0;
  Vec3 g = Vec3::Zero();
};

}  // namespace kappaflow
