// Eq. 12 on a lattice: particles scattered over slabs of lattice planes, one task a slab.
#include <algorithm>
#include <cmath>

#include "core/whole_within.h"
#include "surface/field/particle_field.h"

namespace kappaflow {

namespace {

/// Lattice planes in a slab. Each point's sum runs over the particles in cell order whatever the slabs are.
constexpr int kSlabPlanes = 8;

/// Lattice points of a row that are worked on together.
using RowLanes = Eigen::Array4d;
constexpr int kRowLanes = 4;

/// The lattice indices in [lower, upper] whose coordinate lies within `reach` of `centre`, in units of the
/// spacing.
struct IndexRange {
  IndexRange(double centre, double reach, int lower, int upper)
      : first(whole_within(std::ceil(centre - reach), lower, upper + 1)),
        last(whole_within(std::floor(centre + reach), lower - 1, upper)) {}
  int first, last;
};

/// Sums over particles on some planes of a lattice, in double precision.
class Slab {
 public:
  /// The s-th slab of the samples.
  Slab(const SampledField& samples, int s)
      : dims_(samples.dims),
        offset_(s * kSlabPlanes),
        first_(samples.first_plane + offset_),
        last_(samples.first_plane + std::min(offset_ + kSlabPlanes, dims_[2]) - 1),
        stride_(static_cast<std::size_t>(dims_[0] + kRowLanes - 1)),
        sums_(stride_ * dims_[1] * (last_ - first_ + 1), 0.0) {}

  bool reached(double z, double sigma) const { return z + sigma >= first_ && z - sigma <= last_; }

  /// Adds w (1 - r^2)^3 of one particle; centre and sigma in units of the spacing from the lattice's origin.
  void add(const Vec3& centre, double sigma, double weight);

  /// Writes sum - threshold for the slab's points.
  void write(double threshold, std::vector<float>& value) const;

 private:
  double* row(int j, int k) {
    return sums_.data() + (static_cast<std::size_t>(k - first_) * dims_[1] + j) * stride_;
  }

  std::array<int, 3> dims_;
  int offset_;          // of the slab in the samples
  int first_, last_;    // planes of the lattice
  std::size_t stride_;  // a row may be written up to kRowLanes - 1 points past its end
  std::vector<double> sums_;
  std::vector<RowLanes> dx2_;  // (dx/sigma)^2 of the columns in reach, kept between particles
};

void Slab::add(const Vec3& centre, double sigma, double weight) {
  const IndexRange planes(centre[2], sigma, first_, last_), rows(centre[1], sigma, 0, dims_[1] - 1),
      columns(centre[0], sigma, 0, dims_[0] - 1);
  const double inverse_sigma2 = 1 / (sigma * sigma);
  dx2_.clear();
  for (int i = columns.first; i <= columns.last; i += kRowLanes)
    dx2_.push_back((RowLanes(0, 1, 2, 3) + (i - centre[0])).square() * inverse_sigma2);
  const std::size_t blocks = dx2_.size();
  for (int k = planes.first; k <= planes.last; ++k)
    for (int j = rows.first; j <= rows.last; ++j) {
      const double dy = j - centre[1], dz = k - centre[2], u_yz = 1 - (dy * dy + dz * dz) * inverse_sigma2;
      if (u_yz <= 0) continue;
      double* sums = row(j, k) + columns.first;
      for (std::size_t b = 0; b < blocks; ++b, sums += kRowLanes) {
        const RowLanes u = (u_yz - dx2_[b]).max(0.0);
        Eigen::Map<RowLanes>(sums) += weight * u * u * u;
      }
    }
}

void Slab::write(double threshold, std::vector<float>& value) const {
  const std::size_t rows = static_cast<std::size_t>(dims_[1]) * (last_ - first_ + 1);
  float* out = value.data() + static_cast<std::size_t>(dims_[0]) * dims_[1] * offset_;
  for (std::size_t r = 0; r < rows; ++r)
    for (int i = 0; i < dims_[0]; ++i) *out++ = static_cast<float>(sums_[r * stride_ + i] - threshold);
}

}  // namespace

void ParticleField::sample(SampledField& samples) const {
  const auto& dims = samples.dims;
  samples.value.resize(static_cast<std::size_t>(dims[0]) * dims[1] * dims[2]);
  const double inverse_spacing = 1 / samples.spacing;
  const auto fill_slab = [&](std::size_t s) {
    Slab slab(samples, static_cast<int>(s));
    for (std::size_t p = 0; p < x_.size(); ++p) {
      const Vec3 centre = inverse_spacing * (Vec3(x_[p], y_[p], z_[p]) - samples.origin);
      const double sigma = source_[p].sigma * inverse_spacing;
      if (slab.reached(centre[2], sigma)) slab.add(centre, sigma, weight_[p]);
    }
    slab.write(threshold_, samples.value);
  };
  parallel_for(static_cast<std::size_t>((dims[2] + kSlabPlanes - 1) / kSlabPlanes), fill_slab, 1);
}

}  // namespace kappaflow
