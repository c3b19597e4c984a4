// Eq. 12 of Fujisawa et al. 2011 over the particles in reach.
#include "surface/field/particle_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.h"
#include "surface/field/field_slab.h"
#include "surface/field/jet_sums.h"
#include "surface/field/lanes_of_runs.h"
#include "surface/field/lattice_cubes.h"
#include "surface/field/material_sums.h"
#include "surface/field/strain_sums.h"
#include "surface/field/stray_particles.h"

namespace kappaflow {

void check_field_particles(const FieldParticles& p) {
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

ParticleField::ParticleField(const FieldParticles& particles, double threshold, double time)
    : threshold_(threshold), time_(time), cloud_speed_(particles.cloud_speed) {
  check_field_particles(particles);
  set_particles(particles, without_strays(particles.position, particles.sigma, particles.weight, threshold));
}

ParticleField::ParticleField(const FieldParticles& particles, std::span<const std::uint32_t> kept,
                             double threshold, double time)
    : threshold_(threshold), time_(time), cloud_speed_(particles.cloud_speed) {
  set_particles(particles, kept);
}

void ParticleField::set_particles(const FieldParticles& p, std::span<const std::uint32_t> kept) {
  const std::size_t n = kept.size();
  if (n == 0) return;
  smallest_sigma_ = kInfinity;
  bounds_ = {p.position[kept[0]], p.position[kept[0]]};
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t i = kept[k];
    smallest_sigma_ = std::min(smallest_sigma_, p.sigma[i]);
    bounds_.lower = bounds_.lower.cwiseMin(p.position[i] - Vec3::Constant(p.sigma[i]));
    bounds_.upper = bounds_.upper.cwiseMax(p.position[i] + Vec3::Constant(p.sigma[i]));
    fastest_speed_ = std::max(fastest_speed_, p.velocity[i].norm());
  }
  fastest_speed_ = std::max(fastest_speed_, cloud_speed_);
  std::vector<std::uint32_t> own, coarse;
  for (const std::uint32_t i : kept) (p.sigma[i] < 2 * smallest_sigma_ ? own : coarse).push_back(i);
  if (!coarse.empty()) coarser_.reset(new ParticleField(p, coarse, threshold_, time_));
  sort_by_cell(p, own);
}

void ParticleField::sort_by_cell(const FieldParticles& p, std::span<const std::uint32_t> kept) {
  const std::size_t n = kept.size();
  std::vector<Vec3> place(n);
  for (std::size_t k = 0; k < n; ++k) {
    place[k] = p.position[kept[k]];
    largest_sigma_ = std::max(largest_sigma_, p.sigma[kept[k]]);
  }
  grid_.build(std::span<const Vec3>(place), largest_sigma_);
  for (auto* array : {&x_, &y_, &z_, &inverse_sigma2_, &weight_}) array->resize(n + kWide);
  source_.resize(n);
  parallel_for(n, [&](std::size_t k) {
    const std::size_t i = kept[grid_.order()[k]];
    x_[k] = p.position[i][0];
    y_[k] = p.position[i][1];
    z_[k] = p.position[i][2];
    inverse_sigma2_[k] = 1 / (p.sigma[i] * p.sigma[i]);
    weight_[k] = p.weight[i];
    source_[k] = {p.velocity[i], p.sigma[i], p.weight_rate[i]};
  });
  grid_.forget_points();
}

/// Calls consume(indices) with the particles that have |x - x_i| < sigma_i, at most ParticleHits::kCapacity
/// at a time.
template <class Consume>
void ParticleField::visit_hits(const Vec3& x, const Consume& consume) const {
  std::array<std::uint32_t, ParticleHits::kCapacity + kWide> hit;
  std::size_t count = 0;
  grid_.ranges_near(x, largest_sigma_, [&](std::uint32_t begin, std::uint32_t end) {
    while (begin < end) {
      const auto piece_end =
          static_cast<std::uint32_t>(std::min<std::size_t>(end, begin + (ParticleHits::kCapacity - count)));
      count = append_below_one(begin, piece_end, hit.data(), count, [&](std::uint32_t k) -> WideDouble {
        const auto load = [k](const std::vector<double>& values) {
          return Eigen::Map<const WideDouble>(&values[k]);
        };
        const WideDouble dx = x[0] - load(x_), dy = x[1] - load(y_), dz = x[2] - load(z_);
        return (dx * dx + dy * dy + dz * dz) * load(inverse_sigma2_);
      });
      begin = piece_end;
      if (count < ParticleHits::kCapacity) continue;
      consume(std::span<const std::uint32_t>(hit.data(), count));
      count = 0;
    }
  });
  if (count > 0) consume(std::span<const std::uint32_t>(hit.data(), count));
}

inline void ParticleField::load_hits(const Vec3& x, std::span<const std::uint32_t> indices,
                                     ParticleHits& hits) const {
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
  for (; n % ParticleHits::kLanes != 0; ++n)
    for (double* values : {hits.dx, hits.dy, hits.dz, hits.vx, hits.vy, hits.vz, hits.inverse_sigma2,
                           hits.sigma, hits.weight, hits.weight_rate})
      values[n] = 0;
  hits.count = n;
}

/// Adds all particles in reach of x to each of the sums.
template <class... Sums>
void ParticleField::add_all(const Vec3& x, Sums&... sums) const {
  ParticleHits hits;
  for_each_level([&](const ParticleField& level) {
    level.visit_hits(x, [&](std::span<const std::uint32_t> indices) {
      level.load_hits(x, indices, hits);
      for (std::size_t first = 0; first < hits.count; first += ParticleHits::kLanes)
        (sums.add(hits, first), ...);
    });
  });
}

Jet ParticleField::jet(const Vec3& x) const {
  JetSums sums;
  add_all(x, sums);
  return sums.jet(threshold_, cloud_speed_);
}

Jet ParticleField::jet(const Vec3& x, StrainResponse& strain) const {
  JetSums sums;
  StrainSums strain_sums;
  add_all(x, sums, strain_sums);
  Jet jet = sums.jet(threshold_, cloud_speed_);
  strain = strain_sums.response(jet);
  return jet;
}

Jet ParticleField::first_order_jet(const Vec3& x) const {
  FirstOrderSums sums;
  add_all(x, sums);
  return sums.jet(threshold_, cloud_speed_);
}

std::optional<Vec3> ParticleField::material_velocity(const Vec3& x) const {
  if (cloud_speed_ > 0) return std::nullopt;
  MaterialSums sums;
  add_all(x, sums);
  return material_velocity(sums);
}

MovingPoint ParticleField::moving_point(const Vec3& x) const {
  if (cloud_speed_ > 0) return {first_order_jet(x), std::nullopt};
  FirstOrderSums sums;
  MaterialSums material;
  add_all(x, sums, material);
  return {sums.jet(threshold_, cloud_speed_), material_velocity(material)};
}

std::optional<Vec3> ParticleField::material_velocity(const MaterialSums& sums) const {
  // Small against the kernel's second moment of about 0.09: an affine flow is followed to a percent, and a
  // sheet of particles, whose gradient is undetermined, still gives a regular matrix.
  constexpr double kRidge = 0.001;
  return sums.velocity(kRidge * smallest_sigma_ * smallest_sigma_);
}

ValueAndGradient ParticleField::value_and_gradient(const Vec3& x) const {
  // So few operations that picking the hits first would cost more than evaluating the misses, where u = 0.
  using Lanes = ParticleHits::Lanes;
  Lanes f = Lanes::Zero(), gx = Lanes::Zero(), gy = Lanes::Zero(), gz = Lanes::Zero();
  for_each_level([&](const ParticleField& level) {
    const auto add = [&](std::uint32_t k, const auto& kept) {
      const auto load = [k](const std::vector<double>& values) {
        return Eigen::Map<const Lanes>(&values[k]);
      };
      const Lanes dx = x[0] - load(level.x_), dy = x[1] - load(level.y_), dz = x[2] - load(level.z_);
      const Lanes is2 = load(level.inverse_sigma2_);
      const Lanes u = kept((1 - (dx * dx + dy * dy + dz * dz) * is2).max(0.0));
      const Lanes w_u2 = load(level.weight_) * u * u, p1 = -6 * w_u2 * is2;
      f += w_u2 * u;
      gx += p1 * dx;
      gy += p1 * dy;
      gz += p1 * dz;
    };
    level.grid_.ranges_near(x, level.largest_sigma_,
                            [&](std::uint32_t begin, std::uint32_t end) { add_in_fours(begin, end, add); });
  });
  return {f.sum() - threshold_, Vec3(gx.sum(), gy.sum(), gz.sum())};
}

/// Whether f may be positive where the p-th particle of a level reaches: f <= sum_j w_j - T there, over the
/// particles within sigma_i + sigma_j of it, itself included (see without_strays()). Neighbours in the cell
/// order are asked first: they settle it for all but a few.
bool ParticleField::may_have_surface(const ParticleField& of, std::size_t p) const {
  constexpr std::size_t kAskedFirst = 8;  // on either side in the cell order
  const auto share = [&](const ParticleField& level, std::size_t q) {
    const double reach = of.source_[p].sigma + level.source_[q].sigma, dx = level.x_[q] - of.x_[p],
                 dy = level.y_[q] - of.y_[p], dz = level.z_[q] - of.z_[p];
    return dx * dx + dy * dy + dz * dz < reach * reach ? std::max(level.weight_[q], 0.0) : 0.0;
  };
  double sum = 0;
  for (std::size_t q = p - std::min(p, kAskedFirst); q < std::min(p + kAskedFirst, of.source_.size()); ++q)
    sum += share(of, q);
  if (sum >= threshold_) return true;
  sum = 0;
  for_each_level([&](const ParticleField& level) {
    level.grid_.ranges_near(Vec3(of.x_[p], of.y_[p], of.z_[p]), of.source_[p].sigma + level.largest_sigma_,
                            [&](std::uint32_t begin, std::uint32_t end) {
                              for (std::size_t q = begin; q < end && sum < threshold_; ++q)
                                sum += share(level, q);
                            });
  });
  return sum >= threshold_;
}

std::optional<std::vector<std::array<int, 3>>> ParticleField::occupied_cubes(const SampledField& lattice,
                                                                             int cells) const {
  LatticeCubes cubes(lattice, cells);
  for_each_level([&](const ParticleField& level) {
    std::vector<char> counts(level.source_.size());
    parallel_for(counts.size(), [&](std::size_t p) { counts[p] = may_have_surface(level, p); });
    for (std::size_t p = 0; p < counts.size(); ++p)
      if (counts[p])
        cubes.add(Vec3(level.x_[p], level.y_[p], level.z_[p]), Vec3::Constant(level.source_[p].sigma));
  });
  return std::move(cubes).ascending();
}

void ParticleField::sample(SampledField& samples) const {
  const auto& dims = samples.dims;
  samples.value.resize(static_cast<std::size_t>(dims[0]) * dims[1] * dims[2]);
  const double inverse_spacing = 1 / samples.spacing;
  const Vec3 half = 0.5 * samples.spacing * Vec3(dims[0] - 1, dims[1] - 1, dims[2] - 1),
             middle = samples.origin +
                      samples.spacing * Vec3(samples.first_column, samples.first_row, samples.first_plane) +
                      half;
  const auto fill_slab = [&](std::size_t s) {
    FieldSlab slab(samples, static_cast<int>(s));
    for_each_level([&](const ParticleField& level) {
      level.grid_.ranges_near(
          middle, half.maxCoeff() + level.largest_sigma_, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t p = begin; p < end; ++p) {
              const Vec3 centre =
                  inverse_spacing * (Vec3(level.x_[p], level.y_[p], level.z_[p]) - samples.origin);
              const double sigma = level.source_[p].sigma * inverse_spacing;
              if (slab.reached(centre[2], sigma)) slab.add(centre, sigma, level.weight_[p]);
            }
          });
    });
    slab.write(threshold_, samples.value);
  };
  parallel_for(static_cast<std::size_t>(FieldSlab::count(samples)), fill_slab, 1);
}

}  // namespace kappaflow
