// Fixed-radius neighbour search: a uniform grid whose cells list their points contiguously (a sorted cell
// list).
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "core/bytes.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/types.h"
#include "core/whole_within.h"

namespace kappaflow {

/// How many cells of which size a grid has.
struct CellCounts {
  double cell_size = 1;              ///< [m]
  std::array<int, 3> dims{0, 0, 0};  ///< along each axis
};

/// The cells that `points` points in a box of the size `extent` [m] are sorted by: cell_size > 0 [m] is
/// doubled until there are at most 64 cells a point (65536 for few points), and fewer than 2^31 in all, which
/// indices of 32 bits can tell apart. Throws InvalidInput where the extent is not finite, or for 2^32 points.
CellCounts cell_counts(const Vec3& extent, double cell_size, std::size_t points);

/// Sorts points by the cell that holds them. After build(), the k-th point in cell order is
/// points[order()[k]]; callers copy their data into that order and then read the contiguous ranges that
/// ranges_near() visits. Within a cell the points keep the order in which they came, so the result does not
/// depend on the threads.
class CellGrid {
 public:
  /// Points: any range whose element p has p[0], p[1], p[2] [m], all finite. cell_size > 0 [m]; see
  /// cell_counts(): one particle that flies off costs speed and not memory.
  template <class Point>
  void build(std::span<const Point> points, double cell_size);

  std::span<const std::uint32_t> order() const { return order_; }
  /// Gives back what only order() and cell_at() need.
  void forget_points() {
    order_ = std::vector<std::uint32_t>();  // "= {}" would keep the memory
    cell_of_ = std::vector<std::uint32_t>();
  }
  std::size_t bytes() const { return bytes_of(cell_start_, order_, cell_of_); }

  /// Calls visit(begin, end) for runs [begin, end) of cell order that together hold every point within
  /// `radius` of x along each axis (and others). At most (2 radius / cell size + 2)^2 runs.
  template <class Point, class Visit>
  void ranges_near(const Point& x, double radius, const Visit& visit) const;

  /// The cell of the k-th point in cell order.
  std::uint32_t cell_at(std::size_t k) const { return cell_of_[order_[k]]; }

  std::size_t cells() const { return static_cast<std::size_t>(dims_[0]) * dims_[1] * dims_[2]; }

  /// The cell that holds x; nothing where x is outside the grid.
  template <class Point>
  std::optional<std::uint32_t> cell_holding(const Point& x) const {
    std::array<int, 3> c;
    for (int a = 0; a < 3; ++a) {
      c[a] = clamped_cell(static_cast<double>(x[a]), a);
      if (c[a] < 0 || c[a] >= dims_[a]) return std::nullopt;
    }
    return index_of(c);
  }

  /// As ranges_near(), for every point within build()'s cell_size of any point of the cell: at most 9 runs.
  template <class Visit>
  void ranges_around(std::uint32_t cell, const Visit& visit) const;

 private:
  void sort_by_cell();
  template <class Visit>
  void visit_runs(const std::array<int, 3>& first, const std::array<int, 3>& last, const Visit& visit) const;
  int clamped_cell(double x, int axis) const {
    return whole_within(std::floor((x - lower_[axis]) * inverse_cell_size_), -1, dims_[axis]);
  }

  std::uint32_t index_of(const std::array<int, 3>& c) const {
    return static_cast<std::uint32_t>((static_cast<std::size_t>(c[2]) * dims_[1] + c[1]) * dims_[0] + c[0]);
  }

  Vec3 lower_ = Vec3::Zero();
  double inverse_cell_size_ = 1;
  std::array<int, 3> dims_{0, 0, 0};
  std::vector<std::uint32_t> cell_start_;  // cells + 1 entries; cell index x-fastest
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> cell_of_;  // kept between builds so that a step allocates nothing
};

inline CellCounts cell_counts(const Vec3& extent, double cell_size, std::size_t points) {
  constexpr std::size_t kMinCells = std::size_t{1} << 16, kCellsPerPoint = 64;
  constexpr double kMostCells = std::numeric_limits<int>::max();
  if (points > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput(fmt::format("{} points; at most {} can be searched", points,
                                   std::numeric_limits<std::uint32_t>::max()));
  if (!extent.allFinite()) throw InvalidInput("points that are searched are not finite, or too far apart");
  const double limit =
      std::min(static_cast<double>(std::max(kMinCells, kCellsPerPoint * points)), kMostCells);
  for (double size = cell_size;; size *= 2) {
    const Vec3 cells = (extent * (1 / size)).array().floor() + 1;
    if (!(cells.prod() <= limit)) continue;
    return {size, {static_cast<int>(cells[0]), static_cast<int>(cells[1]), static_cast<int>(cells[2])}};
  }
}

template <class Point>
void CellGrid::build(std::span<const Point> points, double cell_size) {
  const std::size_t n = points.size();
  struct Corners {
    Vec3 lower, upper;
  };
  const auto at = [&](std::size_t i) {
    return Vec3(static_cast<double>(points[i][0]), static_cast<double>(points[i][1]),
                static_cast<double>(points[i][2]));
  };
  const Vec3 any = n > 0 ? at(0) : Vec3::Zero();
  const auto [lower, upper] = parallel_reduce(
      n, Corners{any, any},
      [&](std::size_t i) {
        return Corners{at(i), at(i)};
      },
      [](const Corners& a, const Corners& b) {
        return Corners{a.lower.cwiseMin(b.lower), a.upper.cwiseMax(b.upper)};
      },
      4096);
  const CellCounts counts = cell_counts(upper - lower, cell_size, n);
  lower_ = lower;
  inverse_cell_size_ = 1 / counts.cell_size;
  dims_ = counts.dims;

  cell_of_.resize(n);
  parallel_for(n, [&](std::size_t i) {
    std::array<int, 3> c;
    for (int a = 0; a < 3; ++a)
      c[a] = std::clamp(clamped_cell(static_cast<double>(points[i][a]), a), 0, dims_[a] - 1);
    cell_of_[i] = index_of(c);
  });

  sort_by_cell();
}

// Counting sort on one thread: it is bound by memory, and atomic counters on several were slower.
inline void CellGrid::sort_by_cell() {
  cell_start_.assign(cells() + 1, 0);
  for (const std::uint32_t cell : cell_of_) ++cell_start_[cell + 1];
  std::partial_sum(cell_start_.begin(), cell_start_.end(), cell_start_.begin());
  order_.resize(cell_of_.size());
  for (std::size_t i = 0; i < cell_of_.size(); ++i)
    order_[cell_start_[cell_of_[i]]++] = static_cast<std::uint32_t>(i);
  // Filling moved each start to its cell's end, which is the next cell's start: shift back.
  std::rotate(cell_start_.begin(), cell_start_.end() - 1, cell_start_.end());
  cell_start_[0] = 0;
}

template <class Point, class Visit>
void CellGrid::ranges_near(const Point& x, double radius, const Visit& visit) const {
  if (cell_start_.empty()) return;
  std::array<int, 3> first, last;
  for (int a = 0; a < 3; ++a) {
    first[a] = std::max(clamped_cell(static_cast<double>(x[a]) - radius, a), 0);
    last[a] = std::min(clamped_cell(static_cast<double>(x[a]) + radius, a), dims_[a] - 1);
    if (first[a] > last[a]) return;
  }
  visit_runs(first, last, visit);
}

template <class Visit>
void CellGrid::ranges_around(std::uint32_t cell, const Visit& visit) const {
  const std::array<int, 3> at{static_cast<int>(cell % dims_[0]), static_cast<int>(cell / dims_[0] % dims_[1]),
                              static_cast<int>(cell / dims_[0] / dims_[1])};
  std::array<int, 3> first, last;
  for (int a = 0; a < 3; ++a) {
    first[a] = std::max(at[a] - 1, 0);
    last[a] = std::min(at[a] + 1, dims_[a] - 1);
  }
  visit_runs(first, last, visit);
}

template <class Visit>
void CellGrid::visit_runs(const std::array<int, 3>& first, const std::array<int, 3>& last,
                          const Visit& visit) const {
  for (int cz = first[2]; cz <= last[2]; ++cz)
    for (int cy = first[1]; cy <= last[1]; ++cy) {
      const std::size_t row = (static_cast<std::size_t>(cz) * dims_[1] + cy) * dims_[0];
      const std::uint32_t begin = cell_start_[row + first[0]], end = cell_start_[row + last[0] + 1];
      if (begin != end) visit(begin, end);
    }
}

}  // namespace kappaflow
