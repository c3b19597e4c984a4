// Least squares for the affine motion of a piece of an implicit surface, u(y) = a + G (y - x).
#pragma once

#include <Eigen/Core>

#include "surface/field/jet.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {

/// What one surface point y says about the affine motion around it, seven rows [e | c | b] (3, 9 and 1
/// columns): that the motion carries f and its Hessian, up to the field's response to strain,
///   (f_t + g . u - R(E)) / |g| = 0
///   (A_t + C u + G^T A + A G - R''(E)) L^2/|g| = 0
/// with E the symmetric part of G, L = jet.length_scale, C the third derivatives, R'' the Hessian of R. e are
/// the coefficients of u(y) [-], c those of G [m], row by row, b the right-hand side [m/s]. The rows of the
/// Hessian have a weight that bounds what one point can say where |g| vanishes.
using MotionRows = Eigen::Matrix<double, 13, 7>;

/// The rows at a point with g != 0. normal_velocity stands for -f_t g/|g|^2 and may be limited [m/s].
MotionRows motion_rows(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity);

/// Normal equations of the rows of points about a common centre: the sums over the rows of e e^T, e b, e c^T,
/// c c^T, c b side by side, the weight of all, and b^2.
struct MotionEquations {
  static constexpr int kShifted =
      36;  ///< e e^T (6), e b (3), e c^T (27): what moving the centre needs comes first
  static constexpr int kSize = 92;  ///< and then c c^T (45), c b (9), the weight, b^2
  Eigen::Array<double, kSize, 1> sums = Eigen::Array<double, kSize, 1>::Zero();

  // Where they stand: a, b are axes of e; j = 3 p + q is the coefficient of G_pq in c, and k >= j likewise.
  static constexpr int ee(int a, int b) { return symmetric_place(a, b); }
  static constexpr int eb(int a) { return 6 + a; }
  static constexpr int ec(int a, int j) { return 9 + 9 * a + j; }
  static constexpr int cc(int j, int k) { return kShifted + j * (17 - j) / 2 + k; }
  static constexpr int cb(int j) { return 81 + j; }
  static constexpr int kWeight = 90, kSquares = 91;
};

/// Sums the rows of points about their common centre x: about x instead of y = x + d a row [e | c | b] is
/// [e | c + e d^T | b], for u(y) = a + G d.
class RowSums {
 public:
  /// Adds the rows about y = x + d with the factor w >= 0.
  void add(const MotionRows& rows, const Vec3& d, double w);

  MotionEquations equations() const;

 private:
  static constexpr int kUnknowns = 12;
  /// Of [e | c]: from the diagonal on, in blocks of four.
  Eigen::Array<double, kUnknowns, kUnknowns> products_ = Eigen::Array<double, kUnknowns, kUnknowns>::Zero();
  Eigen::Array<double, kUnknowns, 1> right_ = Eigen::Array<double, kUnknowns, 1>::Zero();  // with b
  double weight_ = 0, squares_ = 0;
};

/// The unknowns (r G row by row, a), r the radius of a window or another unit of length, and their normal
/// equations.
using MotionUnknowns = Eigen::Matrix<double, 12, 1>;
using MotionInformation = Eigen::Matrix<double, 12, 12>;

/// The fitted motion about the centre of a window.
struct AffineFit {
  Vec3 velocity = Vec3::Zero();  ///< a [m/s]
  Mat3 gradient = Mat3::Zero();  ///< G [1/s]
  /// How strongly the rows bind the velocity where everything else is free to adapt: the square root of the
  /// smallest eigenvalue, over the directions in the tangent plane, of the information about a (the Schur
  /// complement of the weighted mean of the normal equations) [-]. 0: a tangential motion that no row sees.
  double determined = 0;
  /// Root mean square of the rows with the fitted motion [m/s]: how far the surface is from moving affinely.
  double residual = 0;
  double radius = 0;                                          ///< r of the window [m]; 0: nothing was fitted
  MotionInformation information = MotionInformation::Zero();  ///< that of the mean of the rows, damped
};

/// Weighted sums of equations about other centres y = x + d, moved to the centre x as RowSums moves rows. So,
/// with w the factors,
///   e e^T -> sum w e e^T,    e b -> sum w e b,    e_a c_pq -> sum w e_a c_pq + sum w d_q e_a e_p,
///   c_pq b -> sum w c_pq b + sum w d_q e_p b,
///   c_pq c_st -> sum w c_pq c_st + sum w d_q e_p c_st + sum w d_t e_s c_pq + sum w d_q d_t e_p e_s:
/// linear in the moments of order 0, 1 and 2 in d. See docs/regional.md.
class WindowSums {
 public:
  explicit WindowSums(const Vec3& centre) : centre_(centre) {}

  /// Adds the equations about y with the factor w >= 0.
  void add(const MotionEquations& equations, const Vec3& y, double w);

  double weight() const;

  /// Their sum about the centre, exactly.
  MotionEquations equations() const;

  /// Minimises the weighted mean of the squared rows + |Lambda (a, r G)|^2, r the radius [m] and Lambda =
  /// 3e-5 on a, 3e-4 on the rotation, 3e-2 on the strain: a motion that the rows do not determine is the
  /// least one, translation before rotation before strain. Zero without weight. normal: unit normal at x.
  AffineFit solve(double radius, const Vec3& normal) const;

 private:
  static constexpr int kSecond = 8;  // e e^T (6), and what fills two vectors of four
  template <int Rows, int Columns>
  using Moments = Eigen::Array<double, Rows, Columns>;

  Vec3 centre_;
  Moments<MotionEquations::kSize, 1> zeroth_ = Moments<MotionEquations::kSize, 1>::Zero();       // times w
  Moments<MotionEquations::kShifted, 3> first_ = Moments<MotionEquations::kShifted, 3>::Zero();  // w d
  Moments<kSecond, 6> second_ = Moments<kSecond, 6>::Zero();  // w d d^T, by symmetric_place()
};

}  // namespace kappaflow
