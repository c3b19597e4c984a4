// Eq. 12 on a lattice: particles scattered over slabs of lattice planes, one task a slab.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "surface/field/field.h"
#include "surface/field/field_kernels.h"

namespace kappaflow {

/// Sums over particles on some planes of a lattice, in double precision. Each point's sum runs over the
/// particles in the order in which they are added, whatever the slabs are.
class FieldSlab {
 public:
  /// How many slabs the samples make.
  static int count(const SampledField& samples) { return (samples.dims[2] + kPlanes - 1) / kPlanes; }

  /// The s-th slab of the samples, s in [0, count(samples)).
  FieldSlab(const SampledField& samples, int s);

  /// Whether a particle's support [z - sigma, z + sigma], in units of the spacing from the lattice's origin,
  /// reaches one of the planes.
  bool reached(double z, double sigma) const { return z + sigma >= first_ && z - sigma <= last_; }

  /// Adds w (1 - r^2/sigma^2)^3 of one particle; centre and sigma in units of the spacing from the lattice's
  /// origin.
  void add(const Vec3& centre, double sigma, double weight);

  /// Adds w (1 - d . M d)^3, d from `center`, of one kernel; M (shape), the half box about its support
  /// (extent) and center in units of the spacing from the lattice's origin.
  void add(const Vec3& center, const SymmetricMatrix& shape, const Vec3& extent, double weight);

  /// Writes sum - threshold for the slab's points; value: of the whole of the samples.
  void write(double threshold, std::vector<float>& value) const;

 private:
  static constexpr int kPlanes = 8;
  /// Lattice points of a row that are worked on together.
  using RowLanes = Eigen::Array4d;
  static constexpr int kRowLanes = 4;

  double* row(int j, int k) {
    return sums_.data() + (static_cast<std::size_t>(k - first_) * dims_[1] + (j - first_row_)) * stride_;
  }

  std::array<int, 3> dims_;
  int first_column_, first_row_;  // of the lattice
  int offset_;                    // of the slab in the samples
  int first_, last_;              // planes of the lattice
  std::size_t stride_;            // a row may be written up to kRowLanes - 1 points past its end
  std::vector<double> sums_;
  std::vector<RowLanes> dx2_;  // (dx/sigma)^2 of the columns in reach, kept between particles
};

}  // namespace kappaflow
