// The aperture problem's cure of Lucas & Kanade 1981, on a surface and with second-order rows: many points
// vote for one affine motion.
#include "surface/motion/affine_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "surface/motion/pointwise.h"

namespace kappaflow {
namespace {

constexpr double kHessianWeight = 0.3;
constexpr double kLargestRows = 30;  // rows of the Hessian beyond this size have their weight reduced
// Lambda: small enough not to slow a rigid motion, large enough to choose among motions no row tells apart.
constexpr double kTranslationDamping = 3e-5, kRotationDamping = 3e-4, kStrainDamping = 3e-2;

/// Columns e (3), c (9), b.
using Rows = Eigen::Matrix<double, 7, 13>;

constexpr int kAxes[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
constexpr int kPair[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

// Where the sums of MotionEquations begin.
constexpr int kEB = 6, kEC = 9, kCC = MotionEquations::kShifted, kCB = 81, kWeight = 90;

/// Coefficients of G of the row (i, k) of G^T A + A G - R'', in the order G_00, G_01, ...
Eigen::Matrix<double, 1, 9> gradient_coefficients(const Mat3& A, const Mat3& response, int i, int k) {
  Eigen::Matrix<double, 1, 9> c;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      c[3 * a + b] = (b == k ? A(a, i) : 0) + (b == i ? A(a, k) : 0) - response(a, b);
  return c;
}

Rows rows_of(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity) {
  const double g = jet.g.norm(), L = jet.length_scale, scale = L * L / g;
  const std::array<Mat3, 3> C{jet.C.contract(Vec3::UnitX()), jet.C.contract(Vec3::UnitY()),
                              jet.C.contract(Vec3::UnitZ())};
  Rows rows;
  const Vec3 n = jet.g / g;
  rows.row(0) << n.transpose(), -strain.f.reshaped<Eigen::RowMajor>().transpose() / g, n.dot(normal_velocity);
  const double size2 = scale * scale * (C[0].squaredNorm() + C[1].squaredNorm() + C[2].squaredNorm());
  const double weight = std::sqrt(kHessianWeight / (1 + size2 / (kLargestRows * kLargestRows)));
  for (int m = 0; m < 6; ++m) {
    const int i = kAxes[m][0], k = kAxes[m][1];
    const double factor = weight * scale * (i == k ? 1 : std::sqrt(2.0));  // as in the Frobenius norm
    rows.row(1 + m) << C[0](i, k), C[1](i, k), C[2](i, k), gradient_coefficients(jet.A, strain.A[m], i, k),
        -jet.A_t(i, k);
    rows.row(1 + m) *= factor;
  }
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
  const Rows rows = rows_of(jet, strain, normal_velocity);
  const Eigen::Matrix<double, 13, 13> products = rows.transpose().lazyProduct(rows);
  MotionEquations result;
  double* sum = result.sums.data();
  for (const auto& [a, b] : kAxes) *sum++ = products(a, b);
  for (int a = 0; a < 3; ++a) *sum++ = products(a, 12);
  for (int a = 0; a < 3; ++a)
    for (int k = 0; k < 9; ++k) *sum++ = products(a, 3 + k);
  for (int j = 0; j < 9; ++j)
    for (int k = j; k < 9; ++k) *sum++ = products(3 + j, 3 + k);
  for (int k = 0; k < 9; ++k) *sum++ = products(3 + k, 12);
  *sum = 1;
  return result;
}

double WindowSums::weight() const {
  return zeroth_[kWeight];
}

void WindowSums::add(const MotionEquations& equations, const Vec3& y, double w) {
  const Vec3 d = y - centre_;
  zeroth_ += w * equations.sums;
  for (int a = 0; a < 3; ++a) first_.col(a) += w * d[a] * equations.sums.head<MotionEquations::kShifted>();
  for (int m = 0; m < 6; ++m)
    second_.col(m) += w * d[kAxes[m][0]] * d[kAxes[m][1]] * equations.sums.head<8>();
}

MotionEquations WindowSums::equations() const {
  // u(y) = a + G d: a row's coefficients of G_pq about the centre are c_pq + e_p d_q.
  MotionEquations result{.sums = zeroth_};
  for (int j = 0, cc = kCC; j < 9; ++j) {
    const int p = j / 3, q = j % 3;
    result.sums[kCB + j] += first_(kEB + p, q);
    for (int a = 0; a < 3; ++a) result.sums[kEC + 9 * a + j] += first_(kPair[a][p], q);
    for (int k = j; k < 9; ++k, ++cc) {
      const int s = k / 3, t = k % 3;
      result.sums[cc] +=
          first_(kEC + 9 * p + k, q) + first_(kEC + 9 * s + j, t) + second_(kPair[p][s], kPair[q][t]);
    }
  }
  return result;
}

AffineFit WindowSums::solve(double radius, const Vec3& normal) const {
  if (!(weight() > 0)) return {};
  static const Mat9 damping = gradient_damping();
  // Unknowns r G, then a: the Cholesky factor's last block is then that of the information about a.
  const auto sums = equations().sums;
  const double mean = 1 / weight(), per_r = mean / radius, per_r2 = per_r / radius;
  Mat12 N;
  Vec12 rhs;
  for (int j = 0, cc = kCC; j < 9; ++j) {
    rhs[j] = per_r * sums[kCB + j];
    for (int a = 0; a < 3; ++a) N(9 + a, j) = per_r * sums[kEC + 9 * a + j];
    for (int k = j; k < 9; ++k, ++cc) N(k, j) = per_r2 * sums[cc] + damping(k, j);
  }
  for (int a = 0; a < 3; ++a) {
    rhs[9 + a] = mean * sums[kEB + a];
    for (int b = 0; b <= a; ++b) N(9 + a, 9 + b) = mean * sums[kPair[a][b]];
    N(9 + a, 9 + a) += kTranslationDamping * kTranslationDamping;
  }
  const Eigen::LLT<Mat12, Eigen::Lower> factor(N);
  const Vec12 z = factor.matrixL().solve(rhs);
  const Mat3 last = factor.matrixLLT().bottomRightCorner<3, 3>().triangularView<Eigen::Lower>();
  return {.velocity = last.triangularView<Eigen::Lower>().transpose().solve(z.tail<3>()),
          .determined = std::sqrt(tangential_information(last * last.transpose(), normal))};
}

}  // namespace kappaflow
