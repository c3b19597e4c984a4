// Particles in reach of a point, side by side: what the sums of Eq. 12 run over.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace kappaflow {

/// Particles in reach of a point x, copied side by side and padded to whole lanes with particles of no
/// weight.
struct ParticleHits {
  /// Four particles side by side.
  using Lanes = Eigen::Array4d;
  static constexpr std::size_t kLanes = 4;
  /// Most particles that are worked on at once; more in reach are taken in turns.
  static constexpr std::size_t kCapacity = 256;

  static Lanes load(const double* values) { return Eigen::Map<const Lanes, Eigen::Aligned32>(values); }

  std::size_t count;                                               ///< a multiple of kLanes
  alignas(32) double dx[kCapacity], dy[kCapacity], dz[kCapacity];  ///< x - x_i [m]
  alignas(32) double vx[kCapacity], vy[kCapacity], vz[kCapacity];  ///< v_i [m/s]
  alignas(32) double inverse_sigma2[kCapacity], sigma[kCapacity];  ///< [1/m2], [m]
  alignas(32) double weight[kCapacity], weight_rate[kCapacity];    ///< w_i [-], dw_i/dt [1/s]
};

}  // namespace kappaflow
