// The jet of Eq. 12 of Fujisawa et al. 2011, in one pass over the particles in reach.
//
// With s = |x - x_i|^2/sigma^2, u = 1 - s, k = 2/sigma^2 and d = x - x_i, a particle's kernel u^3 has the
// derivatives
//   phi_a   = b1 d_a                                                     b1 = -3 u^2 k
//   phi_ab  = b2 d_a d_b + b1 delta_ab                                   b2 =  6 u k^2
//   phi_abc = b3 d_a d_b d_c + b2 (delta_ab d_c + delta_ac d_b + delta_bc d_a),   b3 = -6 k^3
// and in time each of them changes by w' times itself less w v . grad of itself.
#pragma once

#include <algorithm>

#include "surface/field/jet.h"
#include "surface/field/particle_hits.h"

namespace kappaflow {

/// What four particles add to the jet, as far as several of its sums take it.
struct ParticleTerms {
  using Lanes = ParticleHits::Lanes;
  Lanes d[3], v[3];             // x - x_i, v_i
  Lanes w, w_t, k, u, phi, b1;  // as above
  Lanes w_phi, w_p1, q;         // w phi, w b1, d . v

  /// Of the particles [first, first + ParticleHits::kLanes) of the hits.
  ParticleTerms(const ParticleHits& hits, std::size_t first) {
    const auto load = [first](const double* values) { return ParticleHits::load(values + first); };
    d[0] = load(hits.dx), d[1] = load(hits.dy), d[2] = load(hits.dz);
    v[0] = load(hits.vx), v[1] = load(hits.vy), v[2] = load(hits.vz);
    w = load(hits.weight), w_t = load(hits.weight_rate);
    const Lanes is2 = load(hits.inverse_sigma2);
    k = 2 * is2;
    u = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * is2, phi = u * u * u;
    b1 = -3 * u * u * k;
    w_phi = w * phi, w_p1 = w * b1;
    q = d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
  }
};

/// The sums over particles that make the first derivatives.
struct FirstOrderSums {
  using Lanes = ParticleHits::Lanes;
  Lanes f = Lanes::Zero(), f_t = Lanes::Zero(), sigma = Lanes::Zero(), fastest2 = Lanes::Zero();
  Lanes g[3]{Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};

  void add(const ParticleTerms& p, const Lanes& sigma_of_hits) {
    f += p.w_phi;
    f_t += p.w_t * p.phi - p.w_p1 * p.q;
    sigma += p.w_phi * sigma_of_hits;
    fastest2 = fastest2.max(p.v[0] * p.v[0] + p.v[1] * p.v[1] + p.v[2] * p.v[2]);
    for (int a = 0; a < 3; ++a) g[a] += p.w_p1 * p.d[a];
  }
  /// Adds the particles [first, first + ParticleHits::kLanes) of the hits.
  void add(const ParticleHits& hits, std::size_t first) {
    add(ParticleTerms(hits, first), ParticleHits::load(hits.sigma + first));
  }
  /// Field::first_order_jet() of f, the sum less `threshold`. cloud_speed: see FieldParticles [m/s].
  Jet jet(double threshold, double cloud_speed) const;
};

/// The sums over particles that make a jet, with those of symmetric tensors by symmetric_place().
struct JetSums {
  using Lanes = ParticleHits::Lanes;
  FirstOrderSums first_order;
  Lanes g_t[3], p2_d[3];
  Lanes p1 = Lanes::Zero(), c1 = Lanes::Zero();  // what stands on the diagonals of A and A_t
  Lanes A[6], A_t[6];
  Lanes C[10];

  JetSums() {
    for (Lanes* sums : {g_t, p2_d}) std::fill_n(sums, 3, Lanes::Zero());
    for (Lanes* sums : {A, A_t}) std::fill_n(sums, 6, Lanes::Zero());
    std::fill_n(C, 10, Lanes::Zero());
  }

  /// Adds the particles [first, first + ParticleHits::kLanes) of the hits.
  void add(const ParticleHits& hits, std::size_t first);
  /// The jet of f, the sum less `threshold`. cloud_speed: see FieldParticles [m/s].
  Jet jet(double threshold, double cloud_speed) const;
};

inline void JetSums::add(const ParticleHits& hits, std::size_t first) {
  const ParticleTerms p(hits, first);
  first_order.add(p, ParticleHits::load(hits.sigma + first));
  const auto& d = p.d;
  const auto& v = p.v;
  const Lanes b2 = 6 * p.u * p.k * p.k, p2 = p.w * b2, p3 = -6 * p.w * p.k * p.k * p.k;
  const Lanes w_c1 = p.w_t * p.b1 - p2 * p.q, c2 = p.w_t * b2 - p3 * p.q;

  p1 += p.w_p1;
  c1 += w_c1;
  for (int a = 0, ab = 0, abc = 0; a < 3; ++a) {
    const Lanes p2_da = p2 * d[a], p2_va = p2 * v[a], p3_da = p3 * d[a], c2_da = c2 * d[a];
    g_t[a] += w_c1 * d[a] - p.w_p1 * v[a];
    p2_d[a] += p2_da;
    for (int b = a; b < 3; ++b, ++ab) {
      A[ab] += p2_da * d[b];
      A_t[ab] += c2_da * d[b] - p2_da * v[b] - p2_va * d[b];
      const Lanes p3_da_db = p3_da * d[b];
      for (int c = b; c < 3; ++c, ++abc) C[abc] += p3_da_db * d[c];
    }
  }
}

}  // namespace kappaflow
