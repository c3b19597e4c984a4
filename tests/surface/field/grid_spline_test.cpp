// Quintic splines through values on a grid, against the functions that the values are of.
#include "surface/field/grid_spline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/errors.h"
#include "surface/field/taylor.h"

namespace kappaflow {
namespace {

/// sin(x + 0.3) sqrt(2 + y^2 / 2) exp(-z/3), and all its derivatives up to the third.
template <class Number>
Number wave(const std::array<Number, 3>& p) {
  return sine_and_cosine(p[0] + 0.3).first * sqrt(2.0 + 0.5 * (p[1] * p[1])) * exp(-1.0 / 3 * p[2]);
}

/// So many cells a metre, about the origin: wide enough for its border not to count in the middle.
RegularGrid grid_of(int cells) {
  return {.origin = Vec3(0.1, 0, 0),
          .spacing = Vec3(1.0, 1.1, 0.9) / cells,
          .first = {-19, -20, -21},
          .dims = {39, 41, 44}};
}

std::vector<float> sampled(const RegularGrid& grid) {
  std::vector<float> values;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i)
        values.push_back(
            static_cast<float>(wave<Taylor<1>>(taylor_variables<1>(grid.point(i, j, k))).value()));
  return values;
}

/// The largest errors of the value and of the derivatives of each order, well within the grid.
std::array<double, 4> errors(int cells) {
  const RegularGrid grid = grid_of(cells);
  const GridSpline spline(grid, sampled(grid));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> cell(-1, 1);
  std::array<double, 4> error{};
  for (int n = 0; n < 300; ++n) {
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = grid.origin[a] + grid.spacing[a] * cell(random);
    const Taylor<3> f = wave<Taylor<3>>(taylor_variables<3>(x));
    const auto d = spline.at<3>(x);
    error[0] = std::max(error[0], std::abs(d[0] - f.value()));
    error[1] = std::max(error[1], (Vec3(d[1], d[2], d[3]) - f.gradient()).norm());
    Mat3 A;
    A << d[4], d[5], d[6], d[5], d[7], d[8], d[6], d[8], d[9];
    error[2] = std::max(error[2], (A - f.hessian()).norm());
    const ThirdDerivatives C = f.third_derivatives();
    const std::array third{C.xxx, C.xxy, C.xxz, C.xyy, C.xyz, C.xzz, C.yyy, C.yyz, C.yzz, C.zzz};
    for (std::size_t e = 0; e < third.size(); ++e)
      error[3] = std::max(error[3], std::abs(d[10 + e] - third[e]));
  }
  return error;
}

TEST(GridSpline, IsCloseToTheValuesOfItsPoints) {
  const RegularGrid grid = grid_of(16);
  const std::vector<float> values = sampled(grid);
  const GridSpline spline(grid, values);
  for (int k = 6; k < grid.dims[2] - 6; ++k)
    for (int j = 6; j < grid.dims[1] - 6; ++j)
      for (int i = 6; i < grid.dims[0] - 6; ++i)
        EXPECT_NEAR(spline.at<0>(grid.point(i, j, k))[0], values[grid.index(i, j, k)], 5e-5);
}

// Of order 6 - m for derivatives of order m, as far as single precision shows it.
TEST(GridSpline, ConvergesWithAllDerivatives) {
  const std::array coarse = errors(1), fine = errors(2);
  EXPECT_LT(fine[0], 2e-4);
  EXPECT_LT(fine[3], 0.005);
  for (int m = 0; m < 4; ++m)
    EXPECT_GT(coarse[m] / fine[m], std::pow(2, 6 - m - 0.7)) << "derivatives of order " << m;
}

TEST(GridSpline, DerivativesAreThoseOfItself) {
  const RegularGrid grid = grid_of(16);
  const GridSpline spline(grid, sampled(grid));
  const Vec3 x = grid.point(15, 14, 16) + Vec3(0.03, 0.05, 0.02);
  const double h = 1e-4;
  const auto d = spline.at<3>(x);
  for (int a = 0; a < 3; ++a) {
    const auto up = spline.at<2>(x + h * Vec3::Unit(a)), down = spline.at<2>(x - h * Vec3::Unit(a));
    for (std::size_t e = 0; e < taylor::count(2); ++e) {
      taylor::Exponents raised = taylor::kExponents[e];
      ++raised[a];
      EXPECT_NEAR(d[taylor::index_of(raised)], (up[e] - down[e]) / (2 * h), 1e-5) << a << ' ' << e;
    }
  }
}

TEST(GridSpline, AddsSplinesOnOtherGrids) {
  const RegularGrid grid = grid_of(16);
  const GridSpline wide(grid, sampled(grid));
  RegularGrid part = grid;
  part.first = {grid.first[0] + 2, grid.first[1], grid.first[2] + 1};
  part.dims = {36, 41, 40};
  const GridSpline narrow(part, std::vector<float>(part.size(), 2.0F));
  const GridSpline sum = GridSpline::sum({{&wide, 1, 0}, {&narrow, 0.5, 2}});
  EXPECT_EQ(sum.grid().dims, grid.dims);
  const Vec3 x = grid.point(16, 15, 17);
  EXPECT_NEAR(sum.at<0>(x)[0], wide.at<0>(x)[0] + 1, 1e-6);
  EXPECT_NEAR(sum.at<1>(x)[2], wide.at<1>(x)[2], 1e-5);
}

TEST(GridSpline, IsBelowItsBound) {
  const RegularGrid grid = grid_of(16);
  const GridSpline spline(grid, sampled(grid));
  const std::array first{1, 6, 2}, last{3, 8, 5};
  const double bound = spline.upper_bound(first, last);
  for (int k = 0; k < 30; ++k) {
    const Vec3 share(k % 3 / 2.0, k % 5 / 4.0, k % 7 / 6.0);
    Vec3 x;
    for (int a = 0; a < 3; ++a)
      x[a] = grid.origin[a] + grid.spacing[a] * (first[a] + share[a] * (last[a] - first[a]));
    EXPECT_LE(spline.at<0>(x)[0], bound);
  }
  EXPECT_EQ(spline.upper_bound({50, 6, 2}, {60, 8, 5}), -kInfinity);
}

TEST(GridSpline, RefusesTooFewPoints) {
  const RegularGrid flat{.dims = {8, 8, 2}};
  EXPECT_THROW(GridSpline(flat, std::vector<float>(flat.size())), InvalidInput);
  const RegularGrid cube{.dims = {8, 8, 8}};
  EXPECT_THROW(GridSpline(cube, std::vector<float>(7)), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
