// Eq. 12 of Fujisawa et al. 2011 and its derivatives, in one pass over the particles in reach.
//
// With s = |x - x_i|^2/sigma^2, u = 1 - s, k = 2/sigma^2 and d = x - x_i, a particle's kernel u^3 has the
// derivatives
//   phi_a   = b1 d_a                                                     b1 = -3 u^2 k
//   phi_ab  = b2 d_a d_b + b1 delta_ab                                   b2 =  6 u k^2
//   phi_abc = b3 d_a d_b d_c + b2 (delta_ab d_c + delta_ac d_b + delta_bc d_a),   b3 = -6 k^3
// and in time each of them changes by w' times itself less w v . grad of itself.
#include "surface/field/particle_field.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.h"

namespace kappaflow {

namespace {

/// Four particles side by side.
using Lanes = Eigen::Array4d;
constexpr std::size_t kLanes = 4;

/// Most particles that are worked on at once; more in reach are taken in turns.
constexpr std::size_t kHitCapacity = 256;

Lanes load(const double* values) {
  return Eigen::Map<const Lanes, Eigen::Aligned32>(values);
}

void check(const FieldParticles& p) {
  const std::size_t n = p.position.size();
  if (p.velocity.size() != n || p.sigma.size() != n || p.weight.size() != n || p.weight_rate.size() != n)
    throw InvalidInput(
        fmt::format("field particles: {} positions, {} velocities, {} sigmas, {} weights, {} weight rates; "
                    "the counts must be equal",
                    n, p.velocity.size(), p.sigma.size(), p.weight.size(), p.weight_rate.size()));
  for (std::size_t i = 0; i < n; ++i) {
    if (!(p.sigma[i] > 0) || !std::isfinite(p.sigma[i]))
      throw InvalidInput(fmt::format("field particle {}: sigma is {}; it must be positive", i, p.sigma[i]));
    if (!p.position[i].allFinite() || !p.velocity[i].allFinite() || !std::isfinite(p.weight[i]) ||
        !std::isfinite(p.weight_rate[i]))
      throw InvalidInput(fmt::format("field particle {}: a number is not finite", i));
  }
}

}  // namespace

/// Particles in reach of a point, copied side by side and padded to whole lanes with particles of no weight.
struct ParticleField::Hits {
  std::size_t count;  // a multiple of kLanes
  alignas(32) double dx[kHitCapacity], dy[kHitCapacity], dz[kHitCapacity];
  alignas(32) double vx[kHitCapacity], vy[kHitCapacity], vz[kHitCapacity];
  alignas(32) double inverse_sigma2[kHitCapacity], sigma[kHitCapacity];
  alignas(32) double weight[kHitCapacity], weight_rate[kHitCapacity];
};

/// The sums over particles that make a jet; pairs xx, xy, xz, yy, yz, zz and triples xxx ... zzz in that
/// order.
struct ParticleField::JetSums {
  Lanes f = Lanes::Zero(), f_t = Lanes::Zero(), sigma = Lanes::Zero(), fastest2 = Lanes::Zero();
  Lanes g[3], g_t[3], p2_d[3];
  Lanes p1 = Lanes::Zero(), c1 = Lanes::Zero();  // what stands on the diagonals of A and A_t
  Lanes A[6], A_t[6];
  Lanes C[10];

  JetSums() {
    for (Lanes* sums : {g, g_t, p2_d}) std::fill_n(sums, 3, Lanes::Zero());
    for (Lanes* sums : {A, A_t}) std::fill_n(sums, 6, Lanes::Zero());
    std::fill_n(C, 10, Lanes::Zero());
  }

  void add(const Hits& hits, std::size_t first);
  Jet jet(double threshold, double cloud_speed) const;
};

inline void ParticleField::JetSums::add(const Hits& hits, std::size_t first) {
  const Lanes d[3] = {load(hits.dx + first), load(hits.dy + first), load(hits.dz + first)};
  const Lanes v[3] = {load(hits.vx + first), load(hits.vy + first), load(hits.vz + first)};
  const Lanes w = load(hits.weight + first), w_t = load(hits.weight_rate + first);
  const Lanes is2 = load(hits.inverse_sigma2 + first), k = 2 * is2;
  const Lanes u = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * is2, phi = u * u * u;
  const Lanes b1 = -3 * u * u * k, b2 = 6 * u * k * k;
  const Lanes w_phi = w * phi, w_p1 = w * b1, p2 = w * b2, p3 = -6 * w * k * k * k;
  const Lanes q = d[0] * v[0] + d[1] * v[1] + d[2] * v[2];
  const Lanes w_c1 = w_t * b1 - p2 * q, c2 = w_t * b2 - p3 * q;

  f += w_phi;
  f_t += w_t * phi - w_p1 * q;
  sigma += w_phi * load(hits.sigma + first);
  fastest2 = fastest2.max(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  p1 += w_p1;
  c1 += w_c1;
  for (int a = 0, ab = 0, abc = 0; a < 3; ++a) {
    const Lanes p2_da = p2 * d[a], p2_va = p2 * v[a], p3_da = p3 * d[a], c2_da = c2 * d[a];
    g[a] += w_p1 * d[a];
    g_t[a] += w_c1 * d[a] - w_p1 * v[a];
    p2_d[a] += p2_da;
    for (int b = a; b < 3; ++b, ++ab) {
      A[ab] += p2_da * d[b];
      A_t[ab] += c2_da * d[b] - p2_da * v[b] - p2_va * d[b];
      const Lanes p3_da_db = p3_da * d[b];
      for (int c = b; c < 3; ++c, ++abc) C[abc] += p3_da_db * d[c];
    }
  }
}

inline Jet ParticleField::JetSums::jet(double threshold, double cloud_speed) const {
  const auto symmetric = [](const Lanes(&m)[6], double diagonal) {
    Mat3 s;
    s << m[0].sum() + diagonal, m[1].sum(), m[2].sum(),  //
        m[1].sum(), m[3].sum() + diagonal, m[4].sum(),   //
        m[2].sum(), m[4].sum(), m[5].sum() + diagonal;
    return s;
  };
  Jet jet;
  const double sum = f.sum();
  jet.f = sum - threshold;
  jet.f_t = f_t.sum();
  jet.g = Vec3(g[0].sum(), g[1].sum(), g[2].sum());
  jet.g_t = Vec3(g_t[0].sum(), g_t[1].sum(), g_t[2].sum());
  jet.A = symmetric(A, p1.sum());
  jet.A_t = symmetric(A_t, c1.sum());
  const double qx = p2_d[0].sum(), qy = p2_d[1].sum(), qz = p2_d[2].sum();
  jet.C = {.xxx = C[0].sum() + 3 * qx,
           .xxy = C[1].sum() + qy,
           .xxz = C[2].sum() + qz,
           .xyy = C[3].sum() + qx,
           .xyz = C[4].sum(),
           .xzz = C[5].sum() + qx,
           .yyy = C[6].sum() + 3 * qy,
           .yyz = C[7].sum() + qz,
           .yzz = C[8].sum() + qy,
           .zzz = C[9].sum() + 3 * qz};
  jet.length_scale = sum > 0 ? sigma.sum() / sum : 0;
  jet.fastest_in_reach = std::max(std::sqrt(fastest2.maxCoeff()), cloud_speed);
  return jet;
}

/// The sums over particles that, beside those of the jet, make its response to strain. A particle at x - d
/// moves with u(x) - G d, so that R(E) = sum w grad phi . E d = sum w b1 d . E d.
struct ParticleField::StrainSums {
  Lanes p1_dd[6], p2_ddd[10], p3_dddd[15];
  Lanes p1 = Lanes::Zero();

  StrainSums() {
    std::fill_n(p1_dd, 6, Lanes::Zero());
    std::fill_n(p2_ddd, 10, Lanes::Zero());
    std::fill_n(p3_dddd, 15, Lanes::Zero());
  }

  void add(const Hits& hits, std::size_t first);
  void response(const Jet& jet, StrainResponse& strain) const;
};

inline void ParticleField::StrainSums::add(const Hits& hits, std::size_t first) {
  const Lanes d[3] = {load(hits.dx + first), load(hits.dy + first), load(hits.dz + first)};
  const Lanes w = load(hits.weight + first), is2 = load(hits.inverse_sigma2 + first), k = 2 * is2;
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

/// The derivatives of R(E) with the jet's own sums g = sum w b1 d and A = sum w (b2 d d^T + b1 I):
///   R_c  = sum w b2 d_c d.Ed + 2 (E g)_c
///   R_ce = sum w b3 d_c d_e d.Ed + delta_ce B:E + 2 (B E + E B)_ce + 2 sum w b1 E_ce,   B = sum w b2 d d^T.
inline void ParticleField::StrainSums::response(const Jet& jet, StrainResponse& strain) const {
  // Where a sorted tuple of axes stands in the sums: pairs 00 01 02 11 12 22 and so on.
  constexpr int pair[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  constexpr int triple[3][6] = {{0, 1, 2, 3, 4, 5}, {1, 3, 4, 6, 7, 8}, {2, 4, 5, 7, 8, 9}};
  constexpr int quadruple[6][6] = {{0, 1, 2, 3, 4, 5},    {1, 3, 4, 6, 7, 8},    {2, 4, 5, 7, 8, 9},
                                   {3, 6, 7, 10, 11, 12}, {4, 7, 8, 11, 12, 13}, {5, 8, 9, 12, 13, 14}};
  const double s1 = p1.sum();
  const Mat3 B = jet.A - s1 * Mat3::Identity();
  std::array<double, 10> ddd;
  std::array<double, 15> dddd;
  std::transform(p2_ddd, p2_ddd + 10, ddd.begin(), [](const Lanes& sum) { return sum.sum(); });
  std::transform(p3_dddd, p3_dddd + 15, dddd.begin(), [](const Lanes& sum) { return sum.sum(); });
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      strain.f(a, b) = p1_dd[pair[a][b]].sum();
      for (int c = 0; c < 3; ++c)
        strain.g[c](a, b) = ddd[triple[c][pair[a][b]]] + (a == c) * jet.g[b] + (b == c) * jet.g[a];
      for (int c = 0; c < 3; ++c)
        for (int e = c; e < 3; ++e)
          strain.A[pair[c][e]](a, b) = dddd[quadruple[pair[c][e]][pair[a][b]]] + (c == e) * B(a, b) +
                                       (b == e) * B(c, a) + (a == e) * B(c, b) + (c == a) * B(b, e) +
                                       (c == b) * B(a, e) + s1 * ((a == c && b == e) + (b == c && a == e));
    }
}

ParticleField::ParticleField(const FieldParticles& particles, double threshold, double time)
    : threshold_(threshold), time_(time), cloud_speed_(particles.cloud_speed) {
  check(particles);
  set_particles(particles);
}

void ParticleField::set_particles(const FieldParticles& p) {
  const std::size_t n = p.position.size();
  if (n == 0) return;
  const auto [smallest, largest] = std::minmax_element(p.sigma.begin(), p.sigma.end());
  smallest_sigma_ = *smallest;
  largest_sigma_ = *largest;
  bounds_ = {p.position[0], p.position[0]};
  for (std::size_t i = 0; i < n; ++i) {
    bounds_.lower = bounds_.lower.cwiseMin(p.position[i] - Vec3::Constant(p.sigma[i]));
    bounds_.upper = bounds_.upper.cwiseMax(p.position[i] + Vec3::Constant(p.sigma[i]));
    fastest_speed_ = std::max(fastest_speed_, p.velocity[i].norm());
  }
  fastest_speed_ = std::max(fastest_speed_, cloud_speed_);
  grid_.build(std::span<const Vec3>(p.position), largest_sigma_);
  for (auto* array : {&x_, &y_, &z_, &inverse_sigma2_, &weight_}) array->resize(n);
  source_.resize(n);
  parallel_for(n, [&](std::size_t k) {
    const std::size_t i = grid_.order()[k];
    x_[k] = p.position[i][0];
    y_[k] = p.position[i][1];
    z_[k] = p.position[i][2];
    inverse_sigma2_[k] = 1 / (p.sigma[i] * p.sigma[i]);
    weight_[k] = p.weight[i];
    source_[k] = {p.velocity[i], p.sigma[i], p.weight_rate[i]};
  });
}

/// Appends to `hit`, which holds `count` already, the particles of [begin, end) in reach of x; returns the
/// new count.
inline std::size_t ParticleField::collect_hits(const Vec3& x, std::uint32_t begin, std::uint32_t end,
                                               std::uint32_t* hit, std::size_t count) const {
  std::array<double, kHitCapacity> s;
  const std::uint32_t n = end - begin;
#pragma omp simd
  for (std::uint32_t i = 0; i < n; ++i) {
    const double dx = x[0] - x_[begin + i], dy = x[1] - y_[begin + i], dz = x[2] - z_[begin + i];
    s[i] = (dx * dx + dy * dy + dz * dz) * inverse_sigma2_[begin + i];
  }
  for (std::uint32_t i = 0; i < n; ++i) {  // without a branch: some candidates are hits, in no pattern
    hit[count] = begin + i;
    count += s[i] < 1;
  }
  return count;
}

/// Calls consume(indices) with the particles that have |x - x_i| < sigma_i, at most kHitCapacity at a time.
template <class Consume>
void ParticleField::visit_hits(const Vec3& x, const Consume& consume) const {
  std::array<std::uint32_t, kHitCapacity> hit;
  std::size_t count = 0;
  grid_.ranges_near(x, largest_sigma_, [&](std::uint32_t begin, std::uint32_t end) {
    while (begin < end) {
      const auto piece_end =
          static_cast<std::uint32_t>(std::min<std::size_t>(end, begin + (kHitCapacity - count)));
      count = collect_hits(x, begin, piece_end, hit.data(), count);
      begin = piece_end;
      if (count < kHitCapacity) continue;
      consume(std::span<const std::uint32_t>(hit.data(), count));
      count = 0;
    }
  });
  if (count > 0) consume(std::span<const std::uint32_t>(hit.data(), count));
}

inline void ParticleField::load_hits(const Vec3& x, std::span<const std::uint32_t> indices,
                                     Hits& hits) const {
  std::size_t n = 0;
  for (const std::uint32_t k : indices) {
    const Source& source = source_[k];
    hits.dx[n] = x[0] - x_[k];
    hits.dy[n] = x[1] - y_[k];
    hits.dz[n] = x[2] - z_[k];
    hits.vx[n] = source.velocity[0];
    hits.vy[n] = source.velocity[1];
    hits.vz[n] = source.velocity[2];
    hits.inverse_sigma2[n] = inverse_sigma2_[k];
    hits.sigma[n] = source.sigma;
    hits.weight[n] = weight_[k];
    hits.weight_rate[n] = source.weight_rate;
    ++n;
  }
  for (; n % kLanes != 0; ++n)
    for (double* values : {hits.dx, hits.dy, hits.dz, hits.vx, hits.vy, hits.vz, hits.inverse_sigma2,
                           hits.sigma, hits.weight, hits.weight_rate})
      values[n] = 0;
  hits.count = n;
}

Jet ParticleField::jet(const Vec3& x) const {
  Hits hits;
  JetSums sums;
  visit_hits(x, [&](std::span<const std::uint32_t> indices) {
    load_hits(x, indices, hits);
    for (std::size_t first = 0; first < hits.count; first += kLanes) sums.add(hits, first);
  });
  return sums.jet(threshold_, cloud_speed_);
}

Jet ParticleField::jet(const Vec3& x, StrainResponse& strain) const {
  Hits hits;
  JetSums sums;
  StrainSums strain_sums;
  visit_hits(x, [&](std::span<const std::uint32_t> indices) {
    load_hits(x, indices, hits);
    for (std::size_t first = 0; first < hits.count; first += kLanes) {
      sums.add(hits, first);
      strain_sums.add(hits, first);
    }
  });
  Jet jet = sums.jet(threshold_, cloud_speed_);
  strain_sums.response(jet, strain);
  return jet;
}

ValueAndGradient ParticleField::value_and_gradient(const Vec3& x) const {
  // So few operations that picking the hits first would cost more than evaluating the misses, where u = 0.
  double f = 0, gx = 0, gy = 0, gz = 0;
  grid_.ranges_near(x, largest_sigma_, [&](std::uint32_t begin, std::uint32_t end) {
    // Copies that nothing else can change: the loop vectorises.
    const double *xs = x_.data(), *ys = y_.data(), *zs = z_.data(), *is2s = inverse_sigma2_.data(),
                 *ws = weight_.data();
    const double x0 = x[0], x1 = x[1], x2 = x[2];
    double run_f = 0, run_gx = 0, run_gy = 0, run_gz = 0;
#pragma omp simd reduction(+ : run_f, run_gx, run_gy, run_gz)
    for (std::size_t k = begin; k < end; ++k) {
      const double dx = x0 - xs[k], dy = x1 - ys[k], dz = x2 - zs[k], is2 = is2s[k];
      const double inside = 1 - (dx * dx + dy * dy + dz * dz) * is2, u = inside > 0 ? inside : 0;
      const double w_u2 = ws[k] * u * u, p1 = -6 * w_u2 * is2;
      run_f += w_u2 * u;
      run_gx += p1 * dx;
      run_gy += p1 * dy;
      run_gz += p1 * dz;
    }
    f += run_f, gx += run_gx, gy += run_gy, gz += run_gz;
  });
  return {f - threshold_, Vec3(gx, gy, gz)};
}

std::optional<Vec3> ParticleField::material_velocity(const Vec3& x) const {
  // Small against the kernel's second moment of about 0.09: an affine flow is followed to a percent, and a
  // sheet of particles, whose gradient is undetermined, still gives a regular matrix.
  constexpr double kRidge = 0.001;
  if (cloud_speed_ > 0) return std::nullopt;
  using Vec4 = Eigen::Vector4d;
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> rhs = Eigen::Matrix<double, 4, 3>::Zero();
  visit_hits(x, [&](std::span<const std::uint32_t> indices) {
    for (const std::uint32_t k : indices) {
      const Vec3 d(x_[k] - x[0], y_[k] - x[1], z_[k] - x[2]);
      const double u = 1 - d.squaredNorm() * inverse_sigma2_[k];
      const Vec4 basis(1, d[0] / smallest_sigma_, d[1] / smallest_sigma_, d[2] / smallest_sigma_);
      const Vec4 weighted = u * u * u * basis;
      moment += weighted * basis.transpose();
      rhs += weighted * source_[k].velocity.transpose();
    }
  });
  const double sum = moment(0, 0);
  if (!(sum > 0)) return std::nullopt;
  moment.diagonal().tail<3>().array() += kRidge * sum;
  return Vec3(moment.ldlt().solve(rhs).row(0).transpose());
}

}  // namespace kappaflow
