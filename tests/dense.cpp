#include "tests/dense.h"

#include <Eigen/Dense>

namespace kappaflow::testing {

Eigen::MatrixXd random_orthogonal(std::mt19937& random, int n) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd gauss = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(random); });
  return gauss.householderQr().householderQ();
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd inverse(const Eigen::MatrixXd& A) {
  return A.inverse();
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace kappaflow::testing
