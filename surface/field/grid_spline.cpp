#include "surface/field/grid_spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr int kDegree = 5, kSupport = kDegree + 1;  // of the splines; points that they reach over

/// The values at t, 0 <= t < 1, of the uniform B-splines of one degree that do not vanish there, by the
/// recursion of de Boor; those of the lower degrees are needed for derivatives.
template <int N>
std::array<double, N + 1> basis(double t) {
  std::array<double, N + 1> b{};
  if constexpr (N == 0) {
    b[0] = 1;
  } else {
    const std::array<double, N> lower = basis<N - 1>(t);
    for (int j = 0; j <= N; ++j) {
      if (j > 0) b[j] += (t + N - j) / N * lower[j - 1];
      if (j < N) b[j] += (1 + j - t) / N * lower[j];
    }
  }
  return b;
}

/// The Order-th derivatives of those of degree N: differences of lower ones.
template <int N, int Order>
std::array<double, N + 1> basis_derivative(double t) {
  if constexpr (Order == 0) {
    return basis<N>(t);
  } else {
    const std::array<double, N> lower = basis_derivative<N - 1, Order - 1>(t);
    std::array<double, N + 1> b{};
    for (int j = 0; j <= N; ++j) b[j] = (j > 0 ? lower[j - 1] : 0.0) - (j < N ? lower[j] : 0.0);
    return b;
  }
}

/// Of one axis: the first grid point in reach, and the weights of six from there, for each derivative.
template <int Degree>
struct AxisWeights {
  int first;
  std::array<std::array<double, kSupport>, Degree + 1> order;

  AxisWeights(double x, double origin, double spacing, int offset, int points) {
    constexpr int kFirst = GridSpline::kMargin;
    const double u = (x - origin) / spacing - offset;
    const int cell = whole_within(std::floor(u), kFirst, points - 2 - kFirst);
    first = cell - 2;
    const double t = std::clamp(u - cell, 0.0, 1.0), rate = 1 / spacing;
    order[0] = basis_derivative<kDegree, 0>(t);
    if constexpr (Degree >= 1) order[1] = scaled(basis_derivative<kDegree, 1>(t), rate);
    if constexpr (Degree >= 2) order[2] = scaled(basis_derivative<kDegree, 2>(t), rate * rate);
    if constexpr (Degree >= 3) order[3] = scaled(basis_derivative<kDegree, 3>(t), rate * rate * rate);
  }

 private:
  static std::array<double, kSupport> scaled(std::array<double, kSupport> weights, double factor) {
    for (double& w : weights) w *= factor;
    return weights;
  }
};

/// Several lines of n points side by side, as many as the processor adds at a time.
constexpr std::size_t kLines = 16;

/// Values at the points of lines, n rows of kLines, become coefficients: 1 - d/4 + 13 d^2/240, d the second
/// difference along a line, is the inverse of the splines' values at the points, 1 + d/4 + d^2/120, but for
/// terms of d^3. Mirrored at both ends.
class LineFilter {
 public:
  void apply(std::vector<double>& value, std::size_t n) {
    differences(value, n, second_);
    differences(second_, n, fourth_);
    for (std::size_t i = 0; i < value.size(); ++i)
      value[i] += -1.0 / 4 * second_[i] + 13.0 / 240 * fourth_[i];
  }

 private:
  static void differences(const std::vector<double>& from, std::size_t n, std::vector<double>& to) {
    to.resize(from.size());
    for (std::size_t i = 0; i < n; ++i) {
      const double* const before = &from[(i > 0 ? i - 1 : 1) * kLines];
      const double* const after = &from[(i + 1 < n ? i + 1 : n - 2) * kLines];
      for (std::size_t l = 0; l < kLines; ++l)
        to[i * kLines + l] = before[l] + after[l] - 2 * from[i * kLines + l];
    }
  }

  std::vector<double> second_, fourth_;
};

/// Filters `lines` lines that start at neighbouring places of the array, each of n values `stride` apart.
void filter_lines(float* start, std::size_t n, std::size_t stride, std::size_t lines, std::size_t between,
                  LineFilter& filter, std::vector<double>& scratch) {
  scratch.assign(n * kLines, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t l = 0; l < lines; ++l) scratch[i * kLines + l] = start[i * stride + l * between];
  filter.apply(scratch, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t l = 0; l < lines; ++l)
      start[i * stride + l * between] = static_cast<float>(scratch[i * kLines + l]);
}

/// Along one axis: n values `stride` apart, on lines that begin in `rows` rows `step` apart of `columns`
/// places `between` apart.
void filter_axis(float* data, std::size_t n, std::size_t stride, std::size_t rows, std::size_t step,
                 std::size_t columns, std::size_t between) {
  const std::size_t bundles = (columns + kLines - 1) / kLines;
  parallel_for(
      rows * bundles,
      [&](std::size_t task) {
        const std::size_t first = task % bundles * kLines;
        std::vector<double> scratch;
        LineFilter filter;
        filter_lines(data + task / bundles * step + first * between, n, stride,
                     std::min(kLines, columns - first), between, filter, scratch);
      },
      1);
}

}  // namespace

GridSpline::GridSpline(const RegularGrid& grid, std::vector<float> values)
    : grid_(grid), coefficient_(std::move(values)) {
  if (*std::ranges::min_element(grid_.dims) < kFewestPoints || coefficient_.size() != grid_.size())
    throw InvalidInput(
        fmt::format("a grid of {} x {} x {} points with {} values; expected at least {} along "
                    "each axis and a value a point",
                    grid_.dims[0], grid_.dims[1], grid_.dims[2], coefficient_.size(), kFewestPoints));
  const std::size_t nx = grid_.dims[0], ny = grid_.dims[1], nz = grid_.dims[2];
  float* const data = coefficient_.data();
  filter_axis(data, nx, 1, nz, nx * ny, ny, nx);
  filter_axis(data, ny, nx, nz, nx * ny, nx, 1);
  filter_axis(data, nz, nx * ny, ny, nx, nx, 1);
}

GridSpline GridSpline::sum(const std::vector<Term>& terms) {
  GridSpline result;
  RegularGrid& grid = result.grid_;
  grid = terms.front().spline->grid_;
  for (const Term& term : terms) {
    const RegularGrid& other = term.spline->grid_;
    for (int a = 0; a < 3; ++a) {
      const int end = std::max(grid.first[a] + grid.dims[a], other.first[a] + other.dims[a]);
      grid.first[a] = std::min(grid.first[a], other.first[a]);
      grid.dims[a] = end - grid.first[a];
    }
  }
  result.coefficient_.resize(grid.size());
  const int nx = grid.dims[0], ny = grid.dims[1];
  parallel_for(
      static_cast<std::size_t>(ny) * static_cast<std::size_t>(grid.dims[2]),
      [&](std::size_t line) {
        const int j = static_cast<int>(line) % ny + grid.first[1],
                  k = static_cast<int>(line) / ny + grid.first[2];
        const std::span<float> row(&result.coefficient_[line * static_cast<std::size_t>(nx)],
                                   static_cast<std::size_t>(nx));
        for (const auto& [spline, weight, outside] : terms) {
          const RegularGrid& from = spline->grid_;
          const int y = j - from.first[1], z = k - from.first[2], begin = from.first[0] - grid.first[0];
          const bool meets = y >= 0 && y < from.dims[1] && z >= 0 && z < from.dims[2];
          const int end = meets ? begin + from.dims[0] : begin;
          const auto w = static_cast<float>(weight);
          const float* const source = meets ? &spline->coefficient_[from.index(0, y, z)] : nullptr;
          for (int i = 0; i < begin; ++i) row[i] += w * outside;
          for (int i = begin; i < end; ++i) row[i] += w * source[i - begin];
          for (int i = end; i < nx; ++i) row[i] += w * outside;
        }
      },
      16);
  return result;
}

Vec3 GridSpline::inside(const Vec3& x) const {
  const std::array<int, 3>& n = grid_.dims;
  return x.cwiseMax(grid_.point(kMargin, kMargin, kMargin))
      .cwiseMin(grid_.point(n[0] - 1 - kMargin, n[1] - 1 - kMargin, n[2] - 1 - kMargin));
}

template <int Degree>
std::array<double, taylor::count(Degree)> GridSpline::at(const Vec3& x) const {
  const auto weights = [&](int a) {
    return AxisWeights<Degree>(x[a], grid_.origin[a], grid_.spacing[a], grid_.first[a], grid_.dims[a]);
  };
  const AxisWeights<Degree> wx = weights(0), wy = weights(1), wz = weights(2);
  std::array<double, taylor::count(Degree)> result{};
  for (int k = 0; k < kSupport; ++k) {
    std::array<std::array<double, Degree + 1>, Degree + 1> plane{};  // by the derivatives in x and in y
    for (int j = 0; j < kSupport; ++j) {
      const float* const c = &coefficient_[grid_.index(wx.first, wy.first + j, wz.first + k)];
      for (int a = 0; a <= Degree; ++a) {
        double row = 0;
        for (int i = 0; i < kSupport; ++i) row += wx.order[a][i] * static_cast<double>(c[i]);
        for (int b = 0; a + b <= Degree; ++b) plane[a][b] += wy.order[b][j] * row;
      }
    }
    for (std::size_t e = 0; e < result.size(); ++e) {
      const taylor::Exponents& order = taylor::kExponents[e];
      result[e] += wz.order[order[2]][k] * plane[order[0]][order[1]];
    }
  }
  return result;
}

template std::array<double, taylor::count(0)> GridSpline::at<0>(const Vec3& x) const;
template std::array<double, taylor::count(1)> GridSpline::at<1>(const Vec3& x) const;
template std::array<double, taylor::count(2)> GridSpline::at<2>(const Vec3& x) const;
template std::array<double, taylor::count(3)> GridSpline::at<3>(const Vec3& x) const;

double GridSpline::upper_bound(const std::array<int, 3>& first, const std::array<int, 3>& last) const {
  std::array<int, 3> begin, end;
  for (int a = 0; a < 3; ++a) {
    begin[a] = std::max(first[a] - kMargin - grid_.first[a], 0);
    end[a] = std::min(last[a] + kMargin - grid_.first[a] + 1, grid_.dims[a]);
    if (begin[a] >= end[a]) return -kInfinity;
  }
  float largest = coefficient_[grid_.index(begin[0], begin[1], begin[2])];
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j) {
      const float* const row = &coefficient_[grid_.index(begin[0], j, k)];
      largest = std::max(largest, *std::max_element(row, row + (end[0] - begin[0])));
    }
  return largest;
}

}  // namespace kappaflow
