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

/// n . u - R(E)/|g| = n . v_n.
void set_normal_row(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity,
                    MotionRows& rows) {
  const double g = jet.g.norm();
  const Vec3 n = jet.g / g;
  auto row = rows.col(0);
  row.head<3>() = n;
  row.segment<9>(3) = -strain.f.reshaped<Eigen::RowMajor>() / g;
  row[12] = n.dot(normal_velocity);
}

/// C u + G^T A + A G - R''(E) = -A_t, each component times L^2/|g| and the root of kHessianWeight / (1 +
/// s^2/S^2) with s = L^2 |C|/|g| and S = kLargestRows.
void set_hessian_rows(const Jet& jet, const StrainResponse& strain, MotionRows& rows) {
  const double g = jet.g.norm(), L = jet.length_scale, scale = L * L / g;
  double square = 0;  // of the third derivatives
  for_pairs_of_axes([&]<int i, int k>() {
    for (int a = 0; a < 3; ++a) square += (i == k ? 1 : 2) * std::pow(jet.C.at(a, i, k), 2);
  });
  const double size2 = scale * scale * square;
  const double weight = std::sqrt(kHessianWeight / (1 + size2 / (kLargestRows * kLargestRows)));
  for_pairs_of_axes([&]<int i, int k>() {
    constexpr int m = symmetric_place(i, k);
    const double factor = weight * scale * (i == k ? 1 : std::sqrt(2.0));  // as in the Frobenius norm
    double* const row = rows.col(1 + m).data();
    for (int a = 0; a < 3; ++a) {
      row[a] = factor * jet.C.at(a, i, k);
      for (int b = 0; b < 3; ++b) {
        const double carried = (b == k ? jet.A(a, i) : 0) + (b == i ? jet.A(a, k) : 0);
        row[3 + 3 * a + b] = factor * (carried - strain.A[m](a, b));
      }
    }
    row[12] = -factor * jet.A_t(i, k);
  });
}

using Mat9 = Eigen::Matrix<double, 9, 9>;

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
  MotionInformation N;
  MotionUnknowns rhs;
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

MotionRows motion_rows(const Jet& jet, const StrainResponse& strain, const Vec3& normal_velocity) {
  MotionRows rows;
  set_normal_row(jet, strain, normal_velocity, rows);
  set_hessian_rows(jet, strain, rows);
  return rows;
}

void RowSums::add(const MotionRows& rows, const Vec3& d, double w) {
  constexpr int kRows = MotionRows::ColsAtCompileTime;
  Eigen::Array<double, kUnknowns, 3> arm = Eigen::Array<double, kUnknowns, 3>::Zero();
  for (int p = 0; p < 3; ++p) arm.col(p).segment<3>(3 + 3 * p) = d;
  Eigen::Array<double, kUnknowns, kRows> moved, weighted;
  for (int row = 0; row < kRows; ++row) {
    Eigen::Array<double, kUnknowns, 1> column = rows.col(row).head<kUnknowns>();
    for (int p = 0; p < 3; ++p) column += rows(p, row) * arm.col(p);
    moved.col(row) = column;
    weighted.col(row) = w * column;
    right_ += weighted.col(row) * rows(kUnknowns, row);
  }
  for (int k = 0; k < kUnknowns; k += 4)
    for (int j = k; j < kUnknowns; j += 4) {  // blocks of four by four stay in registers
      Eigen::Array44d sum = products_.block<4, 4>(j, k);
      for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < 4; ++column)
          sum.col(column) += weighted(k + column, row) * moved.col(row).segment<4>(j);
      products_.block<4, 4>(j, k) = sum;
    }
  weight_ += w;
  squares_ += w * rows.row(kUnknowns).squaredNorm();
}

MotionEquations RowSums::equations() const {
  using Place = MotionEquations;
  MotionEquations result;
  auto& sum = result.sums;
  for (int a = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) sum[Place::ee(a, b)] = products_(b, a);
    for (int k = 0; k < 9; ++k) sum[Place::ec(a, k)] = products_(3 + k, a);
    sum[Place::eb(a)] = right_[a];
  }
  for (int j = 0; j < 9; ++j) {
    for (int k = j; k < 9; ++k) sum[Place::cc(j, k)] = products_(3 + k, 3 + j);
    sum[Place::cb(j)] = right_[3 + j];
  }
  sum[Place::kWeight] = weight_;
  sum[Place::kSquares] = squares_;
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
  const MotionEquations sum = equations();
  const auto [N, rhs] = damped_mean(sum, radius);
  const Eigen::LLT<MotionInformation, Eigen::Lower> factor(N);
  const MotionUnknowns z = factor.solve(rhs);
  const Mat3 last = factor.matrixLLT().bottomRightCorner<3, 3>().triangularView<Eigen::Lower>();
  return {.velocity = z.tail<3>(),
          .gradient = z.head<9>().reshaped<Eigen::RowMajor>(3, 3) / radius,
          .determined = std::sqrt(tangential_information(last * last.transpose(), normal)),
          .residual = std::sqrt(std::max(0.0, sum.sums[MotionEquations::kSquares] / weight() - z.dot(rhs))),
          .radius = radius,
          .information = N.selfadjointView<Eigen::Lower>()};
}

}  // namespace kappaflow
