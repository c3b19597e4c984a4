#include "solver/isotropic_pressure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/lanes.h"

namespace kappaflow {
namespace {

// Relative densities of particles near a free surface, which M is not for, and of those within the liquid: a
// plane surface of a lattice has 0.85, disorder within liquid makes 0.96 at least.
constexpr float kFreeSurface = 0.9f, kWithin = 0.97f;
// The same for the gradient of density times the spacing, for liquid that is pulled is dense at its surface
// too: there it is 0.5 to 0.6, 0.37 where layers are 1.2 spacings apart; within it is 0.1 in the mean.
constexpr float kSurfaceGradient = 0.35f, kGradientWithin = 0.2f;
// Of viscosity * longest step / spacing^2: below it particles find their places by themselves.
constexpr double kThin = 0.2;
// Of |I - L|: a lattice that is drawn out to 1.35 times its length has 0.37, to 1.5 times 1.1. At 1 and more
// S, which is of the step before, would answer itself; from here on it fades, and is 0 at twice as much.
constexpr float kMostStrained = 0.5f;
// Of a particle's own kappa in its mean with its neighbours', which weigh 3 together.
constexpr float kOwnWeight = 0.5f;

/// xx, yy, zz and yz, xz, xy of a symmetric matrix, padded.
struct Symmetric {
  Vec4f diagonal, other;
};

struct Moments {
  Symmetric second;  // M
  float kappa;       // mean
};

/// With kappa_j in position[j].w, weighted by |V F_ij| x_ij^2.
Moments moments(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists) {
  const Vec4f xi = particles.position[i];
  std::array<Wide, 7> sum;
  sum.fill(Wide::Zero());
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide weight = -lists.factor(block);
    const Wide wx = weight * x, wy = weight * y, wz = weight * z;
    const Wide xx = wx * x, yy = wy * y, zz = wz * z;
    sum[0] += xx;
    sum[1] += yy;
    sum[2] += zz;
    sum[3] += wy * z;
    sum[4] += wx * z;
    sum[5] += wx * y;
    sum[6] += (xx + yy + zz) * xj.w;
  }
  const Moments m{{sums(sum[0], sum[1], sum[2]), sums(sum[3], sum[4], sum[5])}, sum[6].sum()};
  return {m.second, (kOwnWeight * xi[3] + m.kappa) / (kOwnWeight + m.second.diagonal.sum())};
}

/// I - tr(m) / 3 m^-1; without a finite number where m is singular.
Symmetric strained(const Symmetric& m) {
  const Vec4f &d = m.diagonal, &o = m.other;
  const auto products = [](const Vec4f& v) {  // yz, xz, xy
    return Vec4f(shuffled<1, 2, 0, 3>(v).cwiseProduct(shuffled<2, 0, 1, 3>(v)));
  };
  const Vec4f cofactor = products(d) - o.cwiseProduct(o), others = products(o) - d.cwiseProduct(o);
  const float determinant = d[0] * cofactor[0] + o[2] * others[2] + o[1] * others[1];
  const float scale = d.sum() / (3 * determinant);
  return {Vec4f(1, 1, 1, 0) - scale * cofactor, -scale * others};
}

// S in FluidParticles::scratch.
std::vector<Vec4f>& diagonals(FluidParticles& particles) {
  return particles.scratch[0];
}
std::vector<Vec4f>& others(FluidParticles& particles) {
  return particles.scratch[1];
}

/// sum_j (S_i + S_j) V F_ij x_ij. Where S_i is not 0 there is no wall, and sum_j V F_ij x_ij is gradient_sum.
Vec4f force(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
            const std::vector<Vec4f>& diagonal, const std::vector<Vec4f>& other) {
  const Vec4f xi = particles.position[i];
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const WideVec d = gather(diagonal, block), o = gather(other, block);
    const Wide factor = lists.factor(block);
    const Wide x = factor * (xi[0] - xj.x), y = factor * (xi[1] - xj.y), z = factor * (xi[2] - xj.z);
    sum_x += d.x * x + o.z * y + o.y * z;
    sum_y += o.z * x + d.y * y + o.x * z;
    sum_z += o.y * x + o.x * y + d.z * z;
  }
  const Vec4f &g = particles.gradient_sum[i], &o = other[i];
  return sums(sum_x, sum_y, sum_z) + diagonal[i].cwiseProduct(g) +
         Vec4f(o[2] * g[1] + o[1] * g[2], o[2] * g[0] + o[0] * g[2], o[1] * g[0] + o[0] * g[1], 0);
}

}  // namespace

IsotropicPressure::IsotropicPressure(const FluidOptions& options)
    : spacing_(static_cast<float>(options.spacing)) {
  for (std::size_t fluid = 0; fluid < options.fluids(); ++fluid)
    is_thin_.push_back(options.viscosity(fluid) * options.max_time_step <
                       kThin * options.spacing * options.spacing);
  needed_ = std::ranges::count(is_thin_, 0) > 0;
}

/// Of S: 1 within thick liquid, 0 where it has none.
float IsotropicPressure::share(std::size_t i, const FluidParticles& particles, const WallSums& walls) const {
  if (is_thin_[particles.fluid[i]] || walls.touches(i)) return 0;
  const float gradient = spacing_ * particles.gradient_sum[i].norm();
  return std::clamp(std::min((particles.density[i] - kFreeSurface) / (kWithin - kFreeSurface),
                             (kSurfaceGradient - gradient) / (kSurfaceGradient - kGradientWithin)),
                    0.0f, 1.0f);
}

void IsotropicPressure::apply(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                              float time_step) const {
  auto &diagonal = diagonals(particles), &other = others(particles);
  diagonal.resize(particles.size());
  other.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    particles.position[i][3] = particles.density_pressure[i] + particles.divergence_pressure[i];
  });
  fill_kappa_of_ghosts(particles);
  parallel_for(particles.size(), [&](std::size_t i) {
    diagonal[i].setZero();
    other[i].setZero();
    const float within = share(i, particles, walls);
    if (!(within > 0)) return;
    const Moments m = moments(i, particles, lists);
    const Symmetric unlike = strained(m.second);
    const float size = std::sqrt(unlike.diagonal.squaredNorm() + 2 * unlike.other.squaredNorm());
    if (!(size < 2 * kMostStrained)) return;  // or not a number: neighbours in one plane
    const float kappa = within * std::min(1.0f, 2 - size / kMostStrained) * m.kappa;
    diagonal[i] = kappa * unlike.diagonal;
    other[i] = kappa * unlike.other;
  });
  fill_ghosts(particles, diagonal);
  fill_ghosts(particles, other);
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] != 0) return;
    particles.velocity[i] += time_step / particles.mass(i) * force(i, particles, lists, diagonal, other);
  });
}

}  // namespace kappaflow
