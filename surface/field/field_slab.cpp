#include "surface/field/field_slab.h"

#include <algorithm>
#include <cmath>

#include "core/whole_within.h"

namespace kappaflow {
namespace {

/// The lattice indices in [lower, upper] whose coordinate lies within `reach` of `centre`, in units of the
/// spacing.
struct IndexRange {
  IndexRange(double centre, double reach, int lower, int upper)
      : first(whole_within(std::ceil(centre - reach), lower, upper + 1)),
        last(whole_within(std::floor(centre + reach), lower - 1, upper)) {}
  int first, last;
};

}  // namespace

FieldSlab::FieldSlab(const SampledField& samples, int s)
    : dims_(samples.dims),
      first_column_(samples.first_column),
      first_row_(samples.first_row),
      offset_(s * kPlanes),
      first_(samples.first_plane + offset_),
      last_(samples.first_plane + std::min(offset_ + kPlanes, dims_[2]) - 1),
      stride_(static_cast<std::size_t>(dims_[0] + kRowLanes - 1)),
      sums_(stride_ * dims_[1] * (last_ - first_ + 1), 0.0) {}

void FieldSlab::add(const Vec3& centre, double sigma, double weight) {
  const IndexRange planes(centre[2], sigma, first_, last_),
      rows(centre[1], sigma, first_row_, first_row_ + dims_[1] - 1),
      columns(centre[0], sigma, first_column_, first_column_ + dims_[0] - 1);
  const double inverse_sigma2 = 1 / (sigma * sigma);
  dx2_.clear();
  for (int i = columns.first; i <= columns.last; i += kRowLanes)
    dx2_.push_back((RowLanes(0, 1, 2, 3) + (i - centre[0])).square() * inverse_sigma2);
  const std::size_t blocks = dx2_.size();
  for (int k = planes.first; k <= planes.last; ++k)
    for (int j = rows.first; j <= rows.last; ++j) {
      const double dy = j - centre[1], dz = k - centre[2], u_yz = 1 - (dy * dy + dz * dz) * inverse_sigma2;
      if (u_yz <= 0) continue;
      double* sums = row(j, k) + (columns.first - first_column_);
      for (std::size_t b = 0; b < blocks; ++b, sums += kRowLanes) {
        const RowLanes u = (u_yz - dx2_[b]).max(0.0);
        Eigen::Map<RowLanes>(sums) += weight * u * u * u;
      }
    }
}

void FieldSlab::add(const Vec3& center, const SymmetricMatrix& shape, const Vec3& extent, double weight) {
  const IndexRange planes(center[2], extent[2], first_, last_),
      rows(center[1], extent[1], first_row_, first_row_ + dims_[1] - 1);
  const auto& [xx, xy, xz, yy, yz, zz] = shape;
  for (int k = planes.first; k <= planes.last; ++k)
    for (int j = rows.first; j <= rows.last; ++j) {
      // Along a row s = xx (dx - middle)^2 + least.
      const double dy = j - center[1], dz = k - center[2], middle = -(xy * dy + xz * dz) / xx;
      const double u_yz = 1 - (yy * dy * dy + 2 * yz * dy * dz + zz * dz * dz - xx * middle * middle);
      if (u_yz <= 0) continue;
      const IndexRange columns(center[0] + middle, std::sqrt(u_yz / xx), first_column_,
                               first_column_ + dims_[0] - 1);
      double* sums = row(j, k) + (columns.first - first_column_);
      for (int i = columns.first; i <= columns.last; i += kRowLanes, sums += kRowLanes) {
        const RowLanes dx = RowLanes(0, 1, 2, 3) + (i - center[0]) - middle;
        const RowLanes u = (u_yz - xx * dx.square()).max(0.0);
        Eigen::Map<RowLanes>(sums) += weight * u * u * u;
      }
    }
}

void FieldSlab::write(double threshold, std::vector<float>& value) const {
  const std::size_t rows = static_cast<std::size_t>(dims_[1]) * (last_ - first_ + 1);
  float* out = value.data() + static_cast<std::size_t>(dims_[0]) * dims_[1] * offset_;
  for (std::size_t r = 0; r < rows; ++r)
    for (int i = 0; i < dims_[0]; ++i) *out++ = static_cast<float>(sums_[r * stride_ + i] - threshold);
}

}  // namespace kappaflow
