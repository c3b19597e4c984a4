#include "surface/motion/patch_agreement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "surface/mesh/isosurface.h"
#include "tests/dense.h"
#include "tests/surface/field/random_particles.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::random_vector;

constexpr double kSmoothness = 0.003;  // of the header

/// The patches of an ellipsoid's surface, of different length scales, with fits that have nothing in common.
struct Patches {
  SurfaceSamples samples;
  std::vector<double> length_scale;
  std::vector<AffineFit> fits;
};

Patches random_patches(unsigned seed) {
  const TriangleMesh mesh =
      extract_isosurface(testing::EllipsoidField(Vec3::Zero(), Mat3::Identity(), Vec3(1, 1.2, 1.5)), 0.2);
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  Patches patches{
      surface_samples(mesh.position, rings, std::vector<double>(mesh.vertex_count(), 0.8)), {}, {}};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t s = 0; s < patches.samples.vertex.size(); ++s) {
    AffineFit fit;
    fit.velocity = random_vector(random, 1);
    for (int row = 0; row < 3; ++row) fit.gradient.row(row) = random_vector(random, 1).transpose();
    fit.residual = 0.02 + unit(random);
    fit.radius = 0.5 + unit(random);
    const Eigen::MatrixXd Q = testing::random_orthogonal(random, 12);
    Eigen::VectorXd eigenvalues(12);
    for (int j = 0; j < 12; ++j) eigenvalues[j] = std::pow(10, -4 * unit(random));
    fit.information = Q * eigenvalues.asDiagonal() * Q.transpose();
    patches.fits.push_back(fit);
    patches.length_scale.push_back(0.6 + 0.4 * unit(random));
  }
  return patches;
}

double median_residual(const Patches& patches) {
  std::vector<double> residual;
  for (const AffineFit& fit : patches.fits) residual.push_back(fit.residual);
  std::ranges::sort(residual);
  return 0.5 * (residual[(residual.size() - 1) / 2] + residual[residual.size() / 2]);
}

/// (G row by row, a) of all patches, one after the other.
Eigen::VectorXd unknowns(const std::vector<AffineFit>& fits) {
  Eigen::VectorXd z(12 * fits.size());
  for (std::size_t s = 0; s < fits.size(); ++s)
    z.segment<12>(12 * s) << fits[s].gradient.row(0).transpose(), fits[s].gradient.row(1).transpose(),
        fits[s].gradient.row(2).transpose(), fits[s].velocity;
  return z;
}

/// A row for each square of the header's energy, over the unknowns of all patches.
struct Rows {
  std::vector<Eigen::VectorXd> row;
  std::vector<double> right;

  explicit Rows(const Patches& patches) {
    const std::size_t n = patches.fits.size();
    const double m = median_residual(patches);
    const Eigen::VectorXd fitted = unknowns(patches.fits);
    for (std::size_t s = 0; s < n; ++s) {
      const AffineFit& fit = patches.fits[s];
      const double rate = fit.residual > m ? m / fit.residual : 1e6;  // the others stay
      Eigen::Matrix<double, 12, 12> root = Eigen::Matrix<double, 12, 12>::Identity();
      if (fit.residual > m) {
        root = Eigen::MatrixXd(fit.information.llt().matrixU());
        root.leftCols<9>() *= fit.radius;
      }
      for (int j = 0; j < 12; ++j) {
        Eigen::VectorXd r = Eigen::VectorXd::Zero(12 * n);
        r.segment<12>(12 * s) = rate * root.row(j).transpose();
        add(r, r.dot(fitted));
      }
      for (const int t : patches.samples.rings.of(static_cast<int>(s)))
        if (t > static_cast<int>(s)) link(patches, static_cast<int>(s), t);
    }
  }

  void link(const Patches& patches, int s, int t) {
    const Vec3 middle = 0.5 * (patches.samples.position[s] + patches.samples.position[t]);
    const double L = 0.5 * (patches.length_scale[s] + patches.length_scale[t]), root = std::sqrt(kSmoothness);
    const Eigen::Index n = 12 * static_cast<Eigen::Index>(patches.fits.size());
    for (int p = 0; p < 3; ++p) {
      Eigen::VectorXd r = Eigen::VectorXd::Zero(n);
      for (const auto& [patch, sign] : {std::pair(s, 1.0), std::pair(t, -1.0)}) {
        r.segment<3>(12 * patch + 3 * p) = sign * root * (middle - patches.samples.position[patch]);
        r[12 * patch + 9 + p] = sign * root;
      }
      add(r, 0);
    }
    for (int j = 0; j < 9; ++j) {
      Eigen::VectorXd r = Eigen::VectorXd::Zero(n);
      r[12 * s + j] = root * L;
      r[12 * t + j] = -root * L;
      add(r, 0);
    }
  }

  void add(const Eigen::VectorXd& r, double b) {
    row.push_back(r);
    right.push_back(b);
  }

  Eigen::VectorXd solution() const {
    Eigen::MatrixXd A(row.size(), row[0].size());
    for (std::size_t i = 0; i < row.size(); ++i) A.row(i) = row[i].transpose();
    return testing::least_squares(A, Eigen::Map<const Eigen::VectorXd>(right.data(), right.size()));
  }
};

TEST(PatchAgreement, IsTheMinimumOfItsEnergy) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Patches patches = random_patches(seed);
    ASSERT_GT(patches.fits.size(), 12u);
    const Eigen::VectorXd before = unknowns(patches.fits), expected = Rows(patches).solution();
    agree(patches.samples, patches.length_scale, 1, patches.fits);
    const double moved = (expected - before).norm();
    EXPECT_GT(moved, 0.1 * before.norm());
    EXPECT_LT((unknowns(patches.fits) - expected).norm(), 0.03 * moved);
  }
}

TEST(PatchAgreement, LeavesPatchesWhoseRowsAreMet) {
  Patches patches = random_patches(4);
  const double m = median_residual(patches);
  const std::vector<AffineFit> before = patches.fits;
  agree(patches.samples, patches.length_scale, 1, patches.fits);
  std::size_t changed = 0;
  for (std::size_t s = 0; s < before.size(); ++s) {
    const bool is_same =
        before[s].velocity == patches.fits[s].velocity && before[s].gradient == patches.fits[s].gradient;
    EXPECT_EQ(is_same, before[s].residual <= m);
    changed += !is_same;
  }
  EXPECT_GT(changed, before.size() / 3);
  for (AffineFit& fit : patches.fits) fit.residual *= 1e-4;  // below a thousandth of the speed
  const Eigen::VectorXd calm = unknowns(patches.fits);
  agree(patches.samples, patches.length_scale, 1, patches.fits);
  EXPECT_EQ(unknowns(patches.fits), calm);
}

TEST(PatchAgreement, LeavesAnAffineMotion) {
  Patches patches = random_patches(5);
  std::mt19937 random(5);
  Mat3 G;
  for (int row = 0; row < 3; ++row) G.row(row) = random_vector(random, 1).transpose();
  for (std::size_t s = 0; s < patches.fits.size(); ++s) {
    patches.fits[s].gradient = G;
    patches.fits[s].velocity = Vec3(1, 2, 3) + G * patches.samples.position[s];
  }
  const Eigen::VectorXd before = unknowns(patches.fits);
  agree(patches.samples, patches.length_scale, 1, patches.fits);
  EXPECT_LT((unknowns(patches.fits) - before).norm(), 1e-12 * before.norm());
}

TEST(PatchAgreement, PatchesWithoutAFitAreNotAsked) {
  Patches patches = random_patches(6), without = patches;
  without.fits[3] = {};
  without.length_scale[3] = 0;
  without.fits[3].velocity = Vec3(1e6, 0, 0);
  agree(without.samples, without.length_scale, 1, without.fits);
  for (const AffineFit& fit : without.fits)
    if (fit.radius > 0) {
      EXPECT_LT(fit.velocity.norm(), 10);
    }
  std::vector<AffineFit> none(patches.fits.size());
  agree(patches.samples, std::vector<double>(none.size(), 0.0), 0, none);
  EXPECT_EQ(unknowns(none), Eigen::VectorXd::Zero(12 * none.size()));
}

TEST(PatchAgreement, IsTheSameForAnyNumberOfThreads) {
  std::vector<Eigen::VectorXd> results;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Patches patches = random_patches(7);
    agree(patches.samples, patches.length_scale, 1, patches.fits);
    results.push_back(unknowns(patches.fits));
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

}  // namespace
}  // namespace kappaflow
