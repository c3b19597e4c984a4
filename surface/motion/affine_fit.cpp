// The aperture problem's cure of Lucas & Kanade 1981, on a surface and with second-order rows: many points
// vote for one affine motion.
#include "surface/motion/affine_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "surface/motion/tangential.h"

namespace kappaflow {
namespace {

constexpr double kHessianWeight = 0.3;  // [1] beside the normal's row: third derivatives are the noisier ones
constexpr double kLargestRows = 30;     // [1] rows of the Hessian beyond this size have their weight reduced
// Lambda [1]: small enough not to slow a rigid motion, large enough to choose where no row tells which
// motion.
constexpr double kTranslationDamping = 3e-5, kRotationDamping = 3e-4, kStrainDamping = 3e-2;

/// Columns e (3), c (9), b.
using Rows = Eigen::Matrix<double, 7, 13>;

/// Coefficients of G of the row (i, k) of G^T A + A G - R'', in the order G_00, G_01, ...
Eigen::Matrix<double, 1, 9> gradient_coefficients(const Mat3& A, const Mat3& response, int i, int k) {
  Eigen::Matrix<double, 1, 9> c;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      c[3 * a + b] = (b == k ? A(a, i) : 0) + (b == i ? A(a, k) : 0) - response(a, b);
  return c;
}

/// n . u - R(E)/|g| = n . v_n.
void set_normal_row(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity, Rows& rows) {
  const double g = jet.g.norm();
  const Vec3 n = jet.g / g;
  rows.row(0) << n.transpose(), -strain.f.reshaped<Eigen::RowMajor>().transpose() / g, n.dot(normal_velocity);
}

/// C u + G^T A + A G - R''(E) = -A_t, each component times L^2/|g| and the root of kHessianWeight / (1 +
/// s^2/S^2) with s = L^2 |C|/|g| and S = kLargestRows.
void set_hessian_rows(const Jet& jet, const StrainResponse& strain, Rows& rows) {
  const double g = jet.g.norm(), L = jet.length_scale, scale = L * L / g;
  const std::array<Mat3, 3> C{jet.C.contract(Vec3::UnitX()), jet.C.contract(Vec3::UnitY()),
                              jet.C.contract(Vec3::UnitZ())};
  const double size2 = scale * scale * (C[0].squaredNorm() + C[1].squaredNorm() + C[2].squaredNorm());
  const double weight = std::sqrt(kHessianWeight / (1 + size2 / (kLargestRows * kLargestRows)));
  for (int i = 0; i < 3; ++i)
    for (int k = i; k < 3; ++k) {
      const int m = symmetric_place(i, k);
      const double factor = weight * scale * (i == k ? 1 : std::sqrt(2.0));  // as in the Frobenius norm
      rows.row(1 + m) << C[0](i, k), C[1](i, k), C[2](i, k), gradient_coefficients(jet.A, strain.A[m], i, k),
          -jet.A_t(i, k);
      rows.row(1 + m) *= factor;
    }
}

Rows rows_of(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity) {
  Rows rows;
  set_normal_row(jet, strain, normal_velocity, rows);
  set_hessian_rows(jet, strain, rows);
  return rows;
}

using Mat9 = Eigen::Matrix<double, 9, 9>;
using Mat12 = Eigen::Matrix<double, 12, 12>;
using Vec12 = Eigen::Matrix<double, 12, 1>;

/// Lambda^2 for r G: rotation is the antisymmetric part.
Mat9 gradient_damping() {
  constexpr double w2 = kRotationDamping * kRotationDamping, s2 = kStrainDamping * kStrainDamping;
  Mat9 damping = Mat9::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      damping(3 * a + b, 3 * a + b) += 0.5 * (s2 + w2);
      damping(3 * a + b, 3 * b + a) += 0.5 * (s2 - w2);
    }
  return damping;
}

/// The normal equations of a fit, N (r G, a) = rhs, of which N has its lower triangle. With the unknowns in
/// this order the last block of N's Cholesky factor is that of the information about a.
struct NormalEquations {
  Mat12 N;
  Vec12 rhs;
};

/// Those of the weighted mean of the squared rows + |Lambda (a, r G)|^2.
NormalEquations damped_mean(const MotionEquations& equations, double radius) {
  using Place = MotionEquations;
  static const Mat9 damping = gradient_damping();
  const auto& sum = equations.sums;
  const double mean = 1 / sum[Place::kWeight], per_r = mean / radius, per_r2 = per_r / radius;
  NormalEquations result;
  auto& [N, rhs] = result;
  for (int j = 0; j < 9; ++j) {
    rhs[j] = per_r * sum[Place::cb(j)];
    for (int a = 0; a < 3; ++a) N(9 + a, j) = per_r * sum[Place::ec(a, j)];
    for (int k = j; k < 9; ++k) N(k, j) = per_r2 * sum[Place::cc(j, k)] + damping(k, j);
  }
  for (int a = 0; a < 3; ++a) {
    rhs[9 + a] = mean * sum[Place::eb(a)];
    for (int b = 0; b <= a; ++b) N(9 + a, 9 + b) = mean * sum[Place::ee(a, b)];
    N(9 + a, 9 + a) += kTranslationDamping * kTranslationDamping;
  }
  return result;
}

/// Smallest eigenvalue of the information about the tangential velocity: the inverse of the covariance
/// (S^-1) of a within the tangent plane.
double tangential_information(const Mat3& S, const Vec3& normal) {
  const TangentBasis E = tangent_basis(normal);
  const Eigen::Matrix2d covariance = E.transpose() * S.llt().solve(E);
  const double mean = 0.5 * covariance.trace(),
               spread = std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return 1 / (mean + spread);
}

}  // namespace

MotionEquations motion_equations(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity) {
  using Place = MotionEquations;
  const Rows rows = rows_of(jet, strain, normal_velocity);
  const Eigen::Matrix<double, 13, 13> products = rows.transpose().lazyProduct(rows);
  MotionEquations result;
  auto& sum = result.sums;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) sum[Place::ee(a, b)] = products(a, b);
    for (int k = 0; k < 9; ++k) sum[Place::ec(a, k)] = products(a, 3 + k);
    sum[Place::eb(a)] = products(a, 12);
  }
  for (int j = 0; j < 9; ++j) {
    for (int k = j; k < 9; ++k) sum[Place::cc(j, k)] = products(3 + j, 3 + k);
    sum[Place::cb(j)] = products(3 + j, 12);
  }
  sum[Place::kWeight] = 1;
  return result;
}

double WindowSums::weight() const {
  return zeroth_[MotionEquations::kWeight];
}

void WindowSums::add(const MotionEquations& equations, const Vec3& y, double w) {
  const Vec3 d = y - centre_;
  zeroth_ += w * equations.sums;
  for (int p = 0; p < 3; ++p) first_.col(p) += w * d[p] * equations.sums.head<MotionEquations::kShifted>();
  for (int p = 0; p < 3; ++p)
    for (int q = p; q < 3; ++q)
      second_.col(symmetric_place(p, q)) += w * d[p] * d[q] * equations.sums.head<kSecond>();
}

MotionEquations WindowSums::equations() const {
  using Place = MotionEquations;
  MotionEquations result{.sums = zeroth_};
  auto& sum = result.sums;
  for (int j = 0; j < 9; ++j) {
    const int p = j / 3, q = j % 3;
    sum[Place::cb(j)] += first_(Place::eb(p), q);
    for (int a = 0; a < 3; ++a) sum[Place::ec(a, j)] += first_(Place::ee(a, p), q);
    for (int k = j; k < 9; ++k) {
      const int s = k / 3, t = k % 3;
      sum[Place::cc(j, k)] += first_(Place::ec(p, k), q) + first_(Place::ec(s, j), t) +
                              second_(Place::ee(p, s), symmetric_place(q, t));
    }
  }
  return result;
}

AffineFit WindowSums::solve(double radius, const Vec3& normal) const {
  if (!(weight() > 0)) return {};
  const auto [N, rhs] = damped_mean(equations(), radius);
  const Eigen::LLT<Mat12, Eigen::Lower> factor(N);
  const Vec12 z = factor.matrixL().solve(rhs);
  const Mat3 last = factor.matrixLLT().bottomRightCorner<3, 3>().triangularView<Eigen::Lower>();
  return {.velocity = last.triangularView<Eigen::Lower>().transpose().solve(z.tail<3>()),
          .determined = std::sqrt(tangential_information(last * last.transpose(), normal))};
}

}  // namespace kappaflow
