// The jet of Eq. 12 with kernels that are ellipsoids, in one pass over those in reach.
//
// With d = x - c, e = M d, u = 1 - d . e, a kernel w u^3 has the derivatives
//   w phi_a   = b1 e_a                                                    b1 =  -6 w u^2
//   w phi_ab  = b2 e_a e_b + b1 M_ab                                      b2 =  24 w u
//   w phi_abc = b3 e_a e_b e_c + b2 (M_ab e_c + M_ac e_b + M_bc e_a)      b3 = -48 w
// and each of them its rate in time by the product rule, with
//   e' = M' d - M v,   u' = 2 e . v - d . M' d,   v = c'.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "surface/field/jet.h"
#include "surface/field/symmetric_place.h"

namespace kappaflow {

/// Kernels in reach of a point x, copied side by side and padded to whole lanes with kernels of no weight.
struct KernelHits {
  using Lanes = Eigen::Array4d;
  static constexpr std::size_t kLanes = 4;
  /// Most kernels that are worked on at once; more in reach are taken in turns.
  static constexpr std::size_t kCapacity = 128;

  static Lanes load(const double* values) { return Eigen::Map<const Lanes, Eigen::Aligned32>(values); }

  std::size_t count;                                    ///< a multiple of kLanes
  alignas(32) double d[3][kCapacity], v[3][kCapacity];  ///< x - c_i [m], dc_i/dt [m/s]
  alignas(32) double shape[6][kCapacity];               ///< [1/m2]
  alignas(32) double shape_rate[6][kCapacity];          ///< [1/(m2 s)]
  alignas(32) double weight[kCapacity], weight_rate[kCapacity];
  alignas(32) double sigma[kCapacity], speed[kCapacity];  ///< of their particles [m], [m/s]
};

/// What four kernels add to the jet, as far as several of its sums take it.
struct KernelTerms {
  using Lanes = KernelHits::Lanes;
  Lanes d[3], v[3], w, w_t, M[6], M_t[6];  // as above
  Lanes e[3], turned[3];                   // M d, M' d
  Lanes u = Lanes::Ones(), u_t = Lanes::Zero(), u2, b1;

  static Lanes row_times(const Lanes (&matrix)[6], int a, const Lanes (&vector)[3]) {
    return matrix[symmetric_place(a, 0)] * vector[0] + matrix[symmetric_place(a, 1)] * vector[1] +
           matrix[symmetric_place(a, 2)] * vector[2];
  }

  /// Of the kernels [first, first + KernelHits::kLanes) of the hits.
  KernelTerms(const KernelHits& hits, std::size_t first) {
    const auto load = [first](const double* values) { return KernelHits::load(values + first); };
    for (int a = 0; a < 3; ++a) d[a] = load(hits.d[a]), v[a] = load(hits.v[a]);
    for (int ab = 0; ab < 6; ++ab) M[ab] = load(hits.shape[ab]), M_t[ab] = load(hits.shape_rate[ab]);
    w = load(hits.weight), w_t = load(hits.weight_rate);
    for (int a = 0; a < 3; ++a) {
      e[a] = row_times(M, a, d);
      turned[a] = row_times(M_t, a, d);
      u -= d[a] * e[a];
      u_t += 2 * e[a] * v[a] - d[a] * turned[a];
    }
    u2 = u * u;
    b1 = -6 * w * u2;
  }
};

/// The sums over kernels that make the first derivatives.
struct FirstOrderKernelSums {
  using Lanes = KernelHits::Lanes;
  Lanes f = Lanes::Zero(), f_t = Lanes::Zero(), sigma = Lanes::Zero(), fastest = Lanes::Zero();
  Lanes g[3]{Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};

  /// Adds the kernels [first, first + KernelHits::kLanes) of the hits.
  void add(const KernelHits& hits, std::size_t first) { add(KernelTerms(hits, first), hits, first); }
  void add(const KernelTerms& k, const KernelHits& hits, std::size_t first) {
    const Lanes w_phi = k.w * k.u2 * k.u;
    f += w_phi;
    f_t += k.w_t * k.u2 * k.u + 3 * k.w * k.u2 * k.u_t;
    sigma += w_phi * KernelHits::load(hits.sigma + first);
    fastest = fastest.max(KernelHits::load(hits.speed + first));
    for (int a = 0; a < 3; ++a) g[a] += k.b1 * k.e[a];
  }
  /// Field::first_order_jet() of f, the sum less `threshold`. cloud_speed: see FieldParticles [m/s].
  Jet jet(double threshold, double cloud_speed) const;
};

/// The sums over kernels that make a jet, with those of symmetric tensors by symmetric_place().
struct KernelSums {
  using Lanes = KernelHits::Lanes;
  FirstOrderKernelSums first_order;
  Lanes g_t[3], A[6], A_t[6], C[10];

  KernelSums() {
    std::fill_n(g_t, 3, Lanes::Zero());
    for (Lanes* sums : {A, A_t}) std::fill_n(sums, 6, Lanes::Zero());
    std::fill_n(C, 10, Lanes::Zero());
  }

  /// Adds the kernels [first, first + KernelHits::kLanes) of the hits.
  void add(const KernelHits& hits, std::size_t first);
  /// The jet of f, the sum less `threshold`. cloud_speed: see FieldParticles [m/s].
  Jet jet(double threshold, double cloud_speed) const;
};

inline void KernelSums::add(const KernelHits& hits, std::size_t first) {
  const KernelTerms k(hits, first);
  first_order.add(k, hits, first);
  const auto& [d, v, w, w_t, M, M_t, e, turned, u, u_t, u2, b1] = k;
  Lanes e_t[3];
  for (int a = 0; a < 3; ++a) e_t[a] = turned[a] - KernelTerms::row_times(M, a, v);
  const Lanes b2 = 24 * w * u, b3 = -48 * w;
  const Lanes b1_t = -6 * (w_t * u2 + 2 * w * u * u_t), b2_t = 24 * (w_t * u + w * u_t);

  for (int a = 0, ab = 0, abc = 0; a < 3; ++a) {
    g_t[a] += b1_t * e[a] + b1 * e_t[a];
    const Lanes b2_ea = b2 * e[a], b3_ea = b3 * e[a];
    const Lanes A_t_b = b2_t * e[a] + b2 * e_t[a];
    for (int b = a; b < 3; ++b, ++ab) {
      A[ab] += b2_ea * e[b] + b1 * M[ab];
      A_t[ab] += A_t_b * e[b] + b2_ea * e_t[b] + b1_t * M[ab] + b1 * M_t[ab];
      const Lanes at_c = b3_ea * e[b] + b2 * M[ab], b2_eb = b2 * e[b];
      for (int c = b; c < 3; ++c, ++abc)
        C[abc] += at_c * e[c] + b2_eb * M[symmetric_place(a, c)] + b2_ea * M[symmetric_place(b, c)];
    }
  }
}

}  // namespace kappaflow
