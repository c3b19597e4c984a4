// Dense linear algebra for tests, compiled once: each size of matrix that Eigen decomposes costs a test's
// compilation seconds.
#pragma once

#include <Eigen/Core>
#include <random>

namespace kappaflow::testing {

/// Q of the QR decomposition of a matrix of n x n normally distributed numbers.
Eigen::MatrixXd random_orthogonal(std::mt19937& random, int n);

/// The x that minimises |A x - b| for each column of b, by QR with pivoting.
Eigen::MatrixXd least_squares(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b);

Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);

/// Ascending.
Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric);

}  // namespace kappaflow::testing
