// A smooth function through values on a regular grid.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/types.h"
#include "surface/field/taylor_terms.h"

namespace kappaflow {

/// A regular grid: its point (i, j, k) is origin + spacing * (first + (i, j, k)), component by component, 0
/// <= i < dims[0] and so on; index x-fastest. Grids that differ in `first` and `dims` alone fit together.
struct RegularGrid {
  Vec3 origin = Vec3::Zero();
  Vec3 spacing = Vec3::Ones();  ///< [m], > 0
  std::array<int, 3> first{0, 0, 0}, dims{0, 0, 0};

  std::size_t size() const {
    return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) *
           static_cast<std::size_t>(dims[2]);
  }
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(dims[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(dims[0]) +
           static_cast<std::size_t>(i);
  }
  Vec3 point(int i, int j, int k) const {
    return origin + spacing.cwiseProduct(Vec3(first[0] + i, first[1] + j, first[2] + k));
  }
};

/// The tensor product of quintic B-splines through the values at the points of a grid, to the order 6 of its
/// spacing: four continuous derivatives along each axis, so that all of a jet is continuous; third
/// derivatives are of order 3. A value counts within five spacings, so that a kink of the data, as distances
/// have halfway between two sides of a body, is not seen from further away, as it is by splines that
/// interpolate. (The quasi-interpolants of de Boor & Fix 1973.)
class GridSpline {
 public:
  static constexpr int kMargin = 3;  ///< [points] from the grid's border where at() reads nothing outside
  static constexpr int kFewestPoints = 7;  ///< along an axis

  GridSpline() = default;
  /// values: one a point of the grid, which has at least kFewestPoints along each axis; else throws
  /// InvalidInput.
  GridSpline(const RegularGrid& grid, std::vector<float> values);

  const RegularGrid& grid() const { return grid_; }
  double coefficient(int i, int j, int k) const { return coefficient_[grid_.index(i, j, k)]; }

  struct Term {
    const GridSpline* spline;
    double weight;
    float outside;  ///< the spline's coefficients beyond its grid
  };
  /// The sum of weight times spline, on one grid around those of all terms: at least one, on grids that fit
  /// together.
  static GridSpline sum(const std::vector<Term>& terms);

  /// All derivatives up to the degree, 0 to 3, in the order of taylor::kExponents [per m of each axis]. A
  /// point closer to the border than kMargin, or beyond, has those of the nearest that is not. May be called
  /// from many threads.
  template <int Degree>
  std::array<double, taylor::count(Degree)> at(const Vec3& x) const;

  /// The nearest point whose derivatives at() gives as they are.
  Vec3 inside(const Vec3& x) const;

  /// A bound of the spline from above within the cells that touch grid points first to last, both included:
  /// its largest coefficient in reach. Points beyond the grid do not count; -infinity where none is in it.
  double upper_bound(const std::array<int, 3>& first, const std::array<int, 3>& last) const;

 private:
  RegularGrid grid_;
  std::vector<float> coefficient_;
};

}  // namespace kappaflow
