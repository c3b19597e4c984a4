// Eq. 12 on a lattice: particles scattered over slabs of lattice planes, one task a slab.
#include <algorithm>
#include <cmath>

#include "surface/field/particle_field.h"

namespace kappaflow {

namespace {

/// Lattice planes in a slab. Each point's sum runs over the particles in cell order whatever the slabs are.
constexpr int kSlabPlanes = 8;

/// The first and last lattice index, clamped to [lower, upper], whose coordinate lies within `reach` of
/// `centre`; both in units of the spacing from the origin.
struct IndexRange {
  IndexRange(double centre, double reach, int lower, int upper)
      : first(static_cast<int>(std::clamp<double>(std::ceil(centre - reach), lower, upper + 1.0))),
        last(static_cast<int>(std::clamp<double>(std::floor(centre + reach), lower - 1.0, upper))) {}
  int first, last;
};

/// Planes first ... last of the lattice.
struct Slab {
  int first, last;
};

/// Adds w (1 - r^2)^3 to the points of a slab; centre and sigma in units of the spacing from the lattice's
/// origin.
void scatter(const Vec3& centre, double sigma, double weight, const std::array<int, 3>& dims,
             const Slab& slab, std::vector<double>& sums) {
  const double inverse_sigma2 = 1 / (sigma * sigma);
  const IndexRange planes(centre[2], sigma, slab.first, slab.last);
  const IndexRange rows(centre[1], sigma, 0, dims[1] - 1);
  for (int k = planes.first; k <= planes.last; ++k)
    for (int j = rows.first; j <= rows.last; ++j) {
      const double dy = j - centre[1], dz = k - centre[2], reach2 = sigma * sigma - dy * dy - dz * dz;
      if (reach2 <= 0) continue;
      const IndexRange columns(centre[0], std::sqrt(reach2), 0, dims[0] - 1);
      double* row = sums.data() + (static_cast<std::size_t>(k - slab.first) * dims[1] + j) * dims[0];
#pragma omp simd
      for (int i = columns.first; i <= columns.last; ++i) {
        const double dx = i - centre[0], u = std::max(0.0, (reach2 - dx * dx) * inverse_sigma2);
        row[i] += weight * u * u * u;
      }
    }
}

}  // namespace

void ParticleField::sample(SampledField& samples) const {
  const auto& dims = samples.dims;
  const std::size_t plane = static_cast<std::size_t>(dims[0]) * dims[1];
  samples.value.resize(plane * dims[2]);
  const double inverse_spacing = 1 / samples.spacing;
  const auto slabs = static_cast<std::size_t>((dims[2] + kSlabPlanes - 1) / kSlabPlanes);
  const auto fill_slab = [&](std::size_t s) {
    const int first = static_cast<int>(s) * kSlabPlanes;
    const Slab slab{first, std::min(first + kSlabPlanes, dims[2]) - 1};
    std::vector<double> sums(plane * (slab.last - slab.first + 1), 0.0);
    for (std::size_t p = 0; p < x_.size(); ++p) {
      const double z = (z_[p] - samples.origin[2]) * inverse_spacing,
                   sigma = source_[p].sigma * inverse_spacing;
      if (z + sigma < slab.first || z - sigma > slab.last) continue;
      const Vec3 centre((x_[p] - samples.origin[0]) * inverse_spacing,
                        (y_[p] - samples.origin[1]) * inverse_spacing, z);
      scatter(centre, sigma, weight_[p], dims, slab, sums);
    }
    std::transform(sums.begin(), sums.end(),
                   samples.value.begin() + static_cast<std::ptrdiff_t>(plane * first),
                   [&](double sum) { return static_cast<float>(sum - threshold_); });
  };
  parallel_for(slabs, fill_slab, 1);
}

}  // namespace kappaflow
