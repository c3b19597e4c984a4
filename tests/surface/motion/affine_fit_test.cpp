#include "surface/motion/affine_fit.h"

#include <gtest/gtest.h>

#include <numeric>

#include "surface/motion/tangential.h"
#include "tests/dense.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/motion/surface_points.h"
#include "tests/surface/reference_data.h"

namespace kappaflow {
namespace {

using testing::random_vector;

/// The equations of the header at one point as a dense system for (a, G row by row) about the centre x,
/// obtained by trying each unknown in turn; Hessian rows with the weight that the header leaves open.
struct DenseRows {
  Eigen::Matrix<double, 7, 12> R;
  Eigen::Matrix<double, 7, 1> b;
};

DenseRows dense_rows(const ParticleField& field, const Vec3& y, const Vec3& x) {
  StrainResponse strain;
  const Jet jet = field.jet(y, strain);
  const double g = jet.g.norm(), L = jet.length_scale;
  const double steepness =
      (jet.C.contract(Vec3::UnitX()).squaredNorm() + jet.C.contract(Vec3::UnitY()).squaredNorm() +
       jet.C.contract(Vec3::UnitZ()).squaredNorm()) *
      std::pow(L, 4) / (g * g);
  const double weight = std::sqrt(0.3 / (1 + steepness / 900)) * L * L / g;
  const auto residual = [&](const Vec3& a, const Mat3& G, double rates) {
    const Vec3 u = a + G * (y - x);
    Eigen::Matrix<double, 7, 1> r;
    r[0] = (rates * jet.f_t + jet.g.dot(u) - strain.f.cwiseProduct(G).sum()) / g;
    const Mat3 A_rate = rates * jet.A_t + jet.C.contract(u) + G.transpose() * jet.A + jet.A * G;
    for (int i = 0, m = 0; i < 3; ++i)
      for (int k = i; k < 3; ++k, ++m)
        r[1 + m] = weight * (i == k ? 1 : std::sqrt(2)) * (A_rate(i, k) - strain.A[m].cwiseProduct(G).sum());
    return r;
  };
  DenseRows rows;
  for (int a = 0; a < 3; ++a) rows.R.col(a) = residual(Vec3::Unit(a), Mat3::Zero(), 0);
  for (int j = 0; j < 9; ++j) {
    Mat3 G = Mat3::Zero();
    G(j / 3, j % 3) = 1;
    rows.R.col(3 + j) = residual(Vec3::Zero(), G, 0);
  }
  rows.b = -residual(Vec3::Zero(), Mat3::Zero(), 1);
  return rows;
}

struct Window {
  ParticleField field;
  std::vector<Vec3> points;
  Vec3 centre;
};

Window random_window(unsigned seed) {
  testing::Body body = testing::read_body_of_seven();
  std::mt19937 random(seed);
  testing::set_velocities(body.particles, [&](const Vec3&) { return random_vector(random, 1); });
  ParticleField field(body.particles, body.threshold, 0);
  std::vector<Vec3> points = testing::surface_points(field, 40, seed);
  const Vec3 centre = points[0];
  return {std::move(field), std::move(points), centre};
}

AffineFit fit(const Window& window, double radius, const std::vector<double>& weight) {
  WindowSums sums(window.centre);
  for (std::size_t i = 0; i < window.points.size(); ++i) {
    StrainResponse strain;
    const Jet jet = window.field.jet(window.points[i], strain);
    RowSums point;
    point.add(motion_rows(jet, strain, -jet.f_t / jet.g.squaredNorm() * jet.g), Vec3::Zero(), 1);
    sums.add(point.equations(), window.points[i], weight[i]);
  }
  return sums.solve(radius, window.field.jet(window.centre).g.normalized());
}

/// Lambda for (a, G): 3e-5 on a, and on r G 3e-4 for its antisymmetric and 3e-2 for its symmetric part.
Eigen::MatrixXd lambda(double radius) {
  Eigen::MatrixXd result = 3e-5 * Eigen::MatrixXd::Identity(12, 12);
  for (int j = 0; j < 9; ++j) {
    Mat3 G = Mat3::Zero();
    G(j / 3, j % 3) = radius;
    const Mat3 damped = 3e-4 * 0.5 * (G - G.transpose()) + 3e-2 * 0.5 * (G + G.transpose());
    result.col(3 + j) << Vec3::Zero(), damped.row(0).transpose(), damped.row(1).transpose(),
        damped.row(2).transpose();
  }
  return result;
}

// The same sum of squares by a QR of all rows one below the other.
TEST(AffineFit, IsTheLeastSquaresSolutionOfAllRows) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Window window = random_window(seed);
    const double radius = 1.3;
    std::mt19937 random(seed);
    std::vector<double> weight;
    for (std::size_t i = 0; i < window.points.size(); ++i)
      weight.push_back(std::uniform_real_distribution<double>(0.1, 1)(random));
    const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
    Eigen::MatrixXd R(7 * window.points.size() + 12, 12);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(R.rows());
    for (std::size_t i = 0; i < window.points.size(); ++i) {
      const DenseRows rows = dense_rows(window.field, window.points[i], window.centre);
      R.middleRows(7 * i, 7) = std::sqrt(weight[i] / total) * rows.R;
      b.segment(7 * i, 7) = std::sqrt(weight[i] / total) * rows.b;
    }
    R.bottomRows(12) = lambda(radius);
    const Eigen::VectorXd expected = testing::least_squares(R, b);
    const AffineFit result = fit(window, radius, weight);
    EXPECT_LT((result.velocity - expected.head<3>()).norm(), 1e-8 * expected.head<3>().norm());
    // Information about a: the rows' part orthogonal to what G can explain.
    const Eigen::MatrixXd H = R.transpose() * R;
    const Mat3 S = H.topLeftCorner(3, 3) - H.topRightCorner(3, 9) *
                                               testing::inverse(H.bottomRightCorner(9, 9)) *
                                               H.bottomLeftCorner(9, 3);
    const TangentBasis E = tangent_basis(window.field.jet(window.centre).g.normalized());
    const Mat3 S_inverse = S.inverse();
    const Eigen::Matrix2d covariance = E.transpose() * S_inverse * E;
    const double largest = testing::eigenvalues(covariance)[1];
    EXPECT_NEAR(result.determined, 1 / std::sqrt(largest), 1e-8 * result.determined);
  }
}

TEST(AffineFit, DoesNotDependOnTheUnitOfTheWeights) {
  const Window window = random_window(7);
  const AffineFit one = fit(window, 1, std::vector<double>(window.points.size(), 1.0));
  const AffineFit other = fit(window, 1, std::vector<double>(window.points.size(), 1e-8));
  EXPECT_LT((one.velocity - other.velocity).norm(), 1e-9);
  EXPECT_NEAR(one.determined, other.determined, 1e-9);
}

TEST(AffineFit, OfNothingIsNothing) {
  const AffineFit nothing = WindowSums(Vec3::Zero()).solve(1, Vec3::UnitX());
  EXPECT_EQ(nothing.velocity, Vec3(Vec3::Zero()));
  EXPECT_EQ(nothing.determined, 0);
}

}  // namespace
}  // namespace kappaflow
