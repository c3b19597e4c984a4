// How Eq. 12 answers a strain of its particles: the sums beside those of its jet. See docs/regional.md.
#pragma once

#include <algorithm>

#include "surface/field/jet.h"
#include "surface/field/particle_hits.h"

namespace kappaflow {

/// The sums over particles that, beside those of the jet, make its response to strain: w b1 d d, w b2 d d d
/// and w b3 d d d d, with d and b of jet_sums.h, by symmetric_place(). A particle at x - d moves with u(x) -
/// G d, so that
///   R(E) = sum w grad phi . E d = sum w b1 d . E d.
struct StrainSums {
  using Lanes = ParticleHits::Lanes;
  Lanes p1_dd[6], p2_ddd[10], p3_dddd[15];
  Lanes p1 = Lanes::Zero();

  StrainSums() {
    std::fill_n(p1_dd, 6, Lanes::Zero());
    std::fill_n(p2_ddd, 10, Lanes::Zero());
    std::fill_n(p3_dddd, 15, Lanes::Zero());
  }

  /// Adds the particles [first, first + ParticleHits::kLanes) of the hits.
  void add(const ParticleHits& hits, std::size_t first);
  /// R and its derivatives. jet: of the same particles, of which g and A are used:
  ///   R    = sum w b1 d.Ed
  ///   R_c  = sum w b2 d_c d.Ed + 2 (E g)_c
  ///   R_ce = sum w b3 d_c d_e d.Ed + delta_ce B:E + 2 (B E + E B)_ce + 2 sum w b1 E_ce,   B = sum w b2 d
  ///   d^T,
  /// where g = sum w b1 d and A = B + sum w b1 I.
  StrainResponse response(const Jet& jet) const;
};

inline void StrainSums::add(const ParticleHits& hits, std::size_t first) {
  const auto load = [first](const double* values) { return ParticleHits::load(values + first); };
  const Lanes d[3] = {load(hits.dx), load(hits.dy), load(hits.dz)};
  const Lanes w = load(hits.weight), is2 = load(hits.inverse_sigma2), k = 2 * is2;
  const Lanes u = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * is2;
  const Lanes w_p1 = -3 * w * u * u * k, p2 = 6 * w * u * k * k, p3 = -6 * w * k * k * k;
  p1 += w_p1;
  for (int a = 0, ab = 0, abc = 0, abce = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b, ++ab) {
      const Lanes dd = d[a] * d[b];
      p1_dd[ab] += w_p1 * dd;
      const Lanes p2_dd = p2 * dd, p3_dd = p3 * dd;
      for (int c = b; c < 3; ++c, ++abc) {
        p2_ddd[abc] += p2_dd * d[c];
        const Lanes p3_ddd = p3_dd * d[c];
        for (int e = c; e < 3; ++e, ++abce) p3_dddd[abce] += p3_ddd * d[e];
      }
    }
}

}  // namespace kappaflow
