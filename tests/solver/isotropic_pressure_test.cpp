#include "solver/isotropic_pressure.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "solver/pressure.h"
#include "tests/solver/liquid.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

using test::Liquid;

constexpr double kSpacing = 0.1;
constexpr float kTimeStep = 0.5f;

FluidOptions options(double viscosity) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = viscosity;
  return o;
}
const FluidOptions kThick = options(10), kThin = options(1e-3);

/// A cube of a lattice that a linear map of determinant 1 has strained, at rest.
Liquid strained(const Mat3& map, const std::vector<WallSample>& walls = {}) {
  std::vector<Vec3> points = test::block(Vec3::Constant(-0.8), Vec3::Constant(0.8), kSpacing);
  for (Vec3& x : points) x = map * x;
  return {points, std::vector<Vec3>(points.size(), Vec3::Zero()), static_cast<float>(kSpacing), walls};
}
Mat3 drawn_out(double ratio) {
  return Vec3(ratio, 1 / std::sqrt(ratio), 1 / std::sqrt(ratio)).asDiagonal();
}
/// Turned out of the lattice's axes.
Mat3 drawn_out_aslant(double ratio) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return turn * drawn_out(ratio) * turn.transpose();
}

/// Gives every particle kappa(x) in all, of both solves.
template <class Pressure>
void press(Liquid& liquid, const Pressure& kappa) {
  FluidParticles& p = liquid.particles;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const float k = static_cast<float>(kappa(p.position[i].head<3>().cast<double>()));
    p.density_pressure[i] = 1.5f * k;
    p.divergence_pressure[i] = -0.5f * k;
  }
}

/// The accelerations by pressure, with what makes it isotropic.
std::vector<Vec3> accelerations(Liquid& liquid, const FluidOptions& o = kThick) {
  FluidParticles& p = liquid.particles;
  for (Vec4f& v : p.velocity) v.setZero();
  IsotropicPressure(o).apply(p, liquid.lists, liquid.wall_sums, kTimeStep);
  p.density_pressure.swap(p.divergence_pressure);
  for (int twice = 0; twice < 2; ++twice) {
    PressureSolver(o).apply_last(p, liquid.lists, kTimeStep);
    p.density_pressure.swap(p.divergence_pressure);
  }
  p.density_pressure.swap(p.divergence_pressure);
  std::vector<Vec3> result;
  for (const Vec4f& v : p.velocity) result.push_back(v.head<3>().cast<double>() / kTimeStep);
  return result;
}

bool within(const Liquid& liquid, std::size_t i) {
  const Vec4f& x = liquid.particles.position[i];
  return x.head<3>().cwiseAbs().maxCoeff() < 0.25f;
}

/// Largest part across g of the accelerations within.
double across(const Liquid& liquid, const std::vector<Vec3>& a, const Vec3& g) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (within(liquid, i)) most = std::max(most, (a[i] - a[i].dot(g) * g).norm());
  return most;
}

// A pressure that rises along g pushes along -g, and as strongly whatever g's direction, for strained
// particles as for those of a lattice. Without the correction by a third more in one direction than in
// another.
TEST(IsotropicPressure, PushesAlongThePressuresGradient) {
  for (const Mat3& map : {drawn_out(1.25), drawn_out_aslant(1.3), drawn_out_aslant(0.75)}) {
    Liquid liquid = strained(map);
    double size = 0;
    for (const Vec3& g : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, -2, 3).normalized().eval()}) {
      press(liquid, [&](const Vec3& x) { return g.dot(x); });
      const std::vector<Vec3> a = accelerations(liquid);
      for (std::size_t i = 0; i < a.size(); ++i) {
        if (!within(liquid, i)) continue;
        if (size == 0) size = a[i].norm();
        EXPECT_LT((a[i] + size * g).norm(), 1e-3) << "the factors of pairs are rounded";
      }
      if (g.cwiseAbs().maxCoeff() < 1) {
        EXPECT_GT(across(liquid, accelerations(liquid, kThin), g), 0.01);
      }
    }
    EXPECT_NEAR(size, 1, 0.1);
  }
}

// What a uniform pressure does while the liquid is sheared: the virtual work of its pair forces,
// sum_ij f_ij . A x_ij / 2, which is that of a stress. Of an isotropic one it is 0 where tr A = 0.
TEST(IsotropicPressure, DoesNoWorkAgainstShearAndAllAgainstDilation) {
  Liquid liquid = strained(drawn_out_aslant(1.25));
  press(liquid, [](const Vec3& x) { return x.cwiseAbs().maxCoeff() < 0.35 ? 1.0 : 0.0; });
  const auto work = [&](const FluidOptions& o, const Vec3& rates) {
    const std::vector<Vec3> a = accelerations(liquid, o);
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      sum += a[i].dot(rates.asDiagonal() * liquid.particles.position[i].head<3>().cast<double>());
    return sum;
  };
  // Of some 340 particles, each of a kappa of 1, whose sums reach their neighbours alone.
  const Vec3 stretch(1, -0.5, -0.5), dilation(1, 1, 1);
  EXPECT_GT(std::abs(work(kThin, stretch)), 5);
  EXPECT_LT(std::abs(work(kThick, stretch)), 0.1);
  EXPECT_NEAR(work(kThick, dilation), work(kThin, dilation), 1e-3 * work(kThin, dilation));
}

TEST(IsotropicPressure, KeepsMomentum) {
  const auto points = test::blob(0.4, 0.97 * kSpacing);
  std::vector<Vec3> moved;
  for (const Vec3& x : points)
    moved.push_back(x + 0.03 * Vec3(std::sin(40 * x.y()), std::cos(37 * x.z()), std::sin(43 * x.x())));
  Liquid liquid(moved, std::vector<Vec3>(moved.size(), Vec3::Zero()), static_cast<float>(kSpacing));
  press(liquid, [](const Vec3& x) { return 2 + std::sin(20 * x.x()) + std::cos(30 * x.y() * x.z()); });
  FluidParticles& p = liquid.particles;
  for (std::size_t i = 0; i < p.size(); ++i) p.fluid[i] = i % 2;
  FluidOptions two = kThick;
  two.more_viscosities = {10};
  two.more_densities = {400};
  p.mass_of_fluid = masses_of_fluids(two);
  IsotropicPressure(two).apply(p, liquid.lists, liquid.wall_sums, kTimeStep);
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double lengths = 0, arms = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 x = p.position[i].head<3>().cast<double>(),
               momentum = static_cast<double>(p.mass(i)) * p.velocity[i].head<3>().cast<double>();
    linear += momentum;
    angular += x.cross(momentum);
    lengths += momentum.norm();
    arms += x.norm() * momentum.norm();
  }
  EXPECT_GT(lengths / static_cast<double>(p.size()), 0.01);
  EXPECT_LT(linear.norm(), 1e-6 * lengths);
  EXPECT_LT(angular.norm(), 1e-6 * arms);
}

/// How strongly one particle of thick liquid pushes those around it, all of thin liquid, at the same kappa.
float pushed_by(std::size_t i, Liquid& liquid) {
  FluidOptions o = kThin;
  o.more_viscosities = {10};
  FluidParticles& p = liquid.particles;
  for (Vec4f& v : p.velocity) v.setZero();
  std::ranges::fill(p.fluid, std::uint8_t{0});
  p.fluid[i] = 1;
  press(liquid, [](const Vec3&) { return 1.0; });
  IsotropicPressure(o).apply(p, liquid.lists, liquid.wall_sums, kTimeStep);
  float sum = 0;
  for (const Vec4f& v : p.velocity) sum += v.norm();
  return sum;
}
std::size_t middle(const Liquid& liquid) {
  const auto& x = liquid.particles.position;
  return static_cast<std::size_t>(
      std::ranges::min_element(x, {}, [](const Vec4f& at) { return at.head<3>().norm(); }) - x.begin());
}

TEST(IsotropicPressure, LeavesSurfacesAndWalls) {
  std::vector<WallSample> floor;
  for (double x = -1.2; x < 1.2; x += 0.08)
    for (double z = -1.2; z < 1.2; z += 0.08) floor.push_back({Vec3(x, -0.75, z), Vec3::UnitY()});
  Liquid liquid = strained(drawn_out(1.15), floor);
  const FluidParticles& p = liquid.particles;
  float face = 0;
  for (const Vec4f& x : p.position) face = std::max(face, x[0]);
  int inside = 0, outside = 0, at_floor = 0;
  for (std::size_t i = 0; i < p.size(); i += 7) {
    if (liquid.wall_sums.touches(i)) {
      EXPECT_EQ(pushed_by(i, liquid), 0);
      ++at_floor;
    } else if (p.density[i] < 0.89f || std::abs(p.position[i][0]) > face - 0.01f) {
      EXPECT_EQ(pushed_by(i, liquid), 0) << p.density[i];
      ++outside;
    } else if (within(liquid, i)) {
      EXPECT_GT(pushed_by(i, liquid), 0.05f);
      ++inside;
    }
  }
  EXPECT_GT(std::min({inside, outside, at_floor}), 10);
}

// Liquid that comes apart, and liquid that is not dense, is not strained liquid.
TEST(IsotropicPressure, FadesWhereLiquidComesApart) {
  const auto push = [](const Mat3& map) {
    Liquid liquid = strained(map);
    return pushed_by(middle(liquid), liquid);
  };
  const float full = push(drawn_out(1.25));
  EXPECT_GT(push(drawn_out(1.35)), 1.5f * full);
  EXPECT_EQ(push(drawn_out(1.7)), 0);
  EXPECT_LT(push(1.04 * drawn_out(1.25)), 0.5f * full) << "density 0.92";
  EXPECT_EQ(push(1.06 * drawn_out(1.2)), 0) << "density below 0.9";
}

TEST(IsotropicPressure, LeavesLedParticles) {
  Liquid liquid = strained(drawn_out(1.25));
  FluidParticles& p = liquid.particles;
  press(liquid, [](const Vec3& x) { return 1 + x.x(); });
  for (std::size_t i = 0; i < p.size(); ++i) p.led_by[i] = i % 2;
  IsotropicPressure(kThick).apply(p, liquid.lists, liquid.wall_sums, kTimeStep);
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (within(liquid, i)) {
      EXPECT_EQ(p.velocity[i].norm() == 0, p.led_by[i] == 1);
    }
  }
}

TEST(IsotropicPressure, IsNotForThinLiquidAlone) {
  EXPECT_TRUE(IsotropicPressure(kThick).needed());
  EXPECT_FALSE(IsotropicPressure(kThin).needed());
  FluidOptions both = kThin;
  both.more_viscosities = {10};
  EXPECT_TRUE(IsotropicPressure(both).needed());
}

}  // namespace
}  // namespace kappaflow
