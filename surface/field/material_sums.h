// The velocity of the material at a point, as an affine fit to the particles in reach tells it.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <optional>

#include "core/types.h"
#include "surface/field/particle_hits.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {

/// The sums of a moving least squares fit of the particles' velocities with the weights u^3, u = 1 - |d|^2 /
/// sigma_i^2, d = x - x_i.
struct MaterialSums {
  using Lanes = ParticleHits::Lanes;
  Lanes weight = Lanes::Zero();
  Lanes d[3]{Lanes::Zero(), Lanes::Zero(), Lanes::Zero()}, v[3]{Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};
  Lanes dd[6], dv[3][3];  // dd by symmetric_place()

  MaterialSums() {
    std::fill_n(dd, 6, Lanes::Zero());
    for (Lanes(&row)[3] : dv) std::fill_n(row, 3, Lanes::Zero());
  }

  /// Adds the particles [first, first + ParticleHits::kLanes) of the hits.
  void add(const ParticleHits& hits, std::size_t first);
  /// The fit's value at x; nullopt without particles. ridge: added to the mean of d d^T, on its diagonal
  /// [m2].
  std::optional<Vec3> velocity(double ridge) const;
};

inline void MaterialSums::add(const ParticleHits& hits, std::size_t first) {
  const auto load = [first](const double* values) { return ParticleHits::load(values + first); };
  const Lanes x[3] = {load(hits.dx), load(hits.dy), load(hits.dz)};
  const Lanes velocity[3] = {load(hits.vx), load(hits.vy), load(hits.vz)}, is2 = load(hits.inverse_sigma2);
  // Those that only fill the lanes have no sigma, and would be at the point itself.
  const Lanes u = (is2 > 0).select(1 - (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]) * is2, 0.0), w = u * u * u;
  weight += w;
  for (int a = 0, ab = 0; a < 3; ++a) {
    const Lanes w_d = w * x[a];
    d[a] += w_d;
    v[a] += w * velocity[a];
    for (int b = a; b < 3; ++b, ++ab) dd[ab] += w_d * x[b];
    for (int b = 0; b < 3; ++b) dv[a][b] += w_d * velocity[b];
  }
}

/// With means over the weights: the fit v + G (y - x) has the value mean(v) - R^T S^-1 mean(d), S = mean(d
/// d^T) - mean(d) mean(d)^T + ridge I, R = mean(d v^T) - mean(d) mean(v)^T.
inline std::optional<Vec3> MaterialSums::velocity(double ridge) const {
  const double sum = weight.sum();
  if (!(sum > 0)) return std::nullopt;
  Vec3 mean_d, mean_v;
  Mat3 S, R;
  for (int a = 0; a < 3; ++a) mean_d[a] = d[a].sum() / sum, mean_v[a] = v[a].sum() / sum;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      S(a, b) = dd[symmetric_place(a, b)].sum() / sum - mean_d[a] * mean_d[b] + (a == b ? ridge : 0);
      R(a, b) = dv[a][b].sum() / sum - mean_d[a] * mean_v[b];
    }
  return mean_v - R.transpose() * (S.inverse() * mean_d);
}

}  // namespace kappaflow
