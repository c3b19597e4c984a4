#include "surface/field/anisotropic_field.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.h"
#include "surface/field/field_slab.h"
#include "surface/field/kernel_sums.h"
#include "surface/field/lanes_of_runs.h"
#include "surface/field/lattice_cubes.h"
#include "surface/field/stray_particles.h"

namespace kappaflow {
namespace {

/// Half the box about each support [m]: sqrt((M^-1)_aa). Throws InvalidInput where a kernel makes no sense.
std::vector<Vec3> checked_extents(const FieldParticles& particles, const FieldKernels& kernels) {
  const std::size_t n = particles.position.size();
  if (kernels.size() != n || kernels.velocity.size() != n || kernels.shape.size() != n ||
      kernels.shape_rate.size() != n || kernels.weight.size() != n || kernels.weight_rate.size() != n)
    throw InvalidInput(
        fmt::format("{} field particles with {} kernels; the counts of all of their arrays "
                    "must be equal",
                    n, kernels.size()));
  std::vector<Vec3> extent(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Mat3 M = full(kernels.shape[i]), rate = full(kernels.shape_rate[i]);
    const double minor = M(0, 0) * M(1, 1) - M(0, 1) * M(0, 1);
    if (!(M(0, 0) > 0 && minor > 0 && M.determinant() > 0))
      throw InvalidInput(fmt::format("field kernel {}: its shape is not positive definite", i));
    extent[i] = M.inverse().diagonal().cwiseSqrt();
    if (!extent[i].allFinite() || !(extent[i].minCoeff() > 0) || !kernels.center[i].allFinite() ||
        !kernels.velocity[i].allFinite() || !rate.allFinite() || !std::isfinite(kernels.weight[i]) ||
        !std::isfinite(kernels.weight_rate[i]))
      throw InvalidInput(
          fmt::format("field kernel {}: a number is not finite, or its support is a point", i));
  }
  return extent;
}

/// At least the distance of the farthest point of each support from its middle [m].
std::vector<double> reaches_of(std::span<const Vec3> extent) {
  std::vector<double> reach(extent.size());
  std::ranges::transform(extent, reach.begin(), [](const Vec3& e) { return e.norm(); });
  return reach;
}

}  // namespace

AnisotropicField::AnisotropicField(const FieldParticles& particles, const FieldKernels& kernels,
                                   double threshold, double time)
    : pattern_(particles, threshold, time), threshold_(threshold), cloud_speed_(particles.cloud_speed) {
  set_kernels(particles, kernels, checked_extents(particles, kernels));
}

void AnisotropicField::set_kernels(const FieldParticles& particles, const FieldKernels& kernels,
                                   std::span<const Vec3> extent) {
  const std::vector<std::uint32_t> kept =
      without_strays(kernels.center, reaches_of(extent), kernels.weight, threshold_);
  const std::size_t n = kept.size();
  if (n == 0) return;
  std::vector<Vec3> place(n);
  bounds_ = {kernels.center[kept[0]], kernels.center[kept[0]]};
  smallest_sigma_ = kInfinity;
  fastest_speed_ = cloud_speed_;
  for (std::size_t k = 0; k < n; ++k) {
    place[k] = kernels.center[kept[k]];
    const Vec3& half = extent[kept[k]];
    bounds_.lower = bounds_.lower.cwiseMin(place[k] - half);
    bounds_.upper = bounds_.upper.cwiseMax(place[k] + half);
    reach_ = std::max(reach_, half.maxCoeff());
    smallest_sigma_ = std::min(smallest_sigma_, particles.sigma[kept[k]]);
    fastest_speed_ = std::max(fastest_speed_, particles.velocity[kept[k]].norm());
  }
  // With cells half as large as the reach, those about a point hold half as much. (The box of a support may
  // have its corners further away: ranges_near() visits all cells that meet a box.)
  grid_.build(std::span<const Vec3>(place), 0.5 * reach_);
  for (auto& array : center_) array.resize(n + kWide);
  for (auto& array : shape_) array.resize(n + kWide);
  weight_.resize(n + kWide);
  source_.resize(n);
  parallel_for(n, [&](std::size_t k) {
    const std::size_t i = kept[grid_.order()[k]];
    for (int a = 0; a < 3; ++a) center_[a][k] = kernels.center[i][a];
    for (int ab = 0; ab < 6; ++ab) shape_[ab][k] = kernels.shape[i][ab];
    weight_[k] = kernels.weight[i];
    source_[k] = {.velocity = kernels.velocity[i],
                  .shape_rate = kernels.shape_rate[i],
                  .weight_rate = kernels.weight_rate[i],
                  .sigma = particles.sigma[i],
                  .material = particles.velocity[i],
                  .extent = extent[i]};
  });
}

/// Calls consume(indices) with the kernels whose support holds x, at most KernelHits::kCapacity at a time.
template <class Consume>
void AnisotropicField::visit_hits(const Vec3& x, const Consume& consume) const {
  constexpr std::size_t kCapacity = KernelHits::kCapacity;
  std::array<std::uint32_t, 2 * kCapacity + kWide> hit;
  std::size_t count = 0;
  const auto squared_distance = [&](std::uint32_t k) -> WideDouble {
    const auto load = [k](const std::vector<double>& values) {
      return Eigen::Map<const WideDouble>(&values[k]);
    };
    const WideDouble dx = x[0] - load(center_[0]), dy = x[1] - load(center_[1]), dz = x[2] - load(center_[2]);
    return dx * (load(shape_[0]) * dx + 2 * (load(shape_[1]) * dy + load(shape_[2]) * dz)) +
           dy * (load(shape_[3]) * dy + 2 * load(shape_[4]) * dz) + load(shape_[5]) * dz * dz;
  };
  grid_.ranges_near(x, reach_, [&](std::uint32_t begin, std::uint32_t end) {
    for (; begin < end; begin += kCapacity) {
      count = append_below_one(begin, std::min<std::uint32_t>(begin + kCapacity, end), hit.data(), count,
                               squared_distance);
      if (count < kCapacity) continue;
      consume(std::span<const std::uint32_t>(hit.data(), kCapacity));
      std::copy(hit.begin() + kCapacity, hit.begin() + count, hit.begin());
      count -= kCapacity;
    }
  });
  if (count > 0) consume(std::span<const std::uint32_t>(hit.data(), count));
}

inline void AnisotropicField::load_hits(const Vec3& x, std::span<const std::uint32_t> indices,
                                        KernelHits& hits) const {
  std::size_t n = 0;
  for (const std::uint32_t k : indices) {
    const Source& source = source_[k];
    for (int a = 0; a < 3; ++a) {
      hits.d[a][n] = x[a] - center_[a][k];
      hits.v[a][n] = source.velocity[a];
    }
    for (int ab = 0; ab < 6; ++ab) {
      hits.shape[ab][n] = shape_[ab][k];
      hits.shape_rate[ab][n] = source.shape_rate[ab];
    }
    hits.weight[n] = weight_[k];
    hits.weight_rate[n] = source.weight_rate;
    hits.sigma[n] = source.sigma;
    hits.speed[n] = source.material.norm();
    ++n;
  }
  for (; n % KernelHits::kLanes != 0; ++n) {
    for (auto* arrays : {hits.d, hits.v})
      for (int a = 0; a < 3; ++a) arrays[a][n] = 0;
    for (auto* arrays : {hits.shape, hits.shape_rate})
      for (int ab = 0; ab < 6; ++ab) arrays[ab][n] = 0;
    for (double* values : {hits.weight, hits.weight_rate, hits.sigma, hits.speed}) values[n] = 0;
  }
  hits.count = n;
}

/// The jet of all kernels in reach of x, by their sums.
template <class Sums>
Jet AnisotropicField::jet_by(const Vec3& x) const {
  KernelHits hits;
  Sums sums;
  visit_hits(x, [&](std::span<const std::uint32_t> indices) {
    load_hits(x, indices, hits);
    for (std::size_t first = 0; first < hits.count; first += KernelHits::kLanes) sums.add(hits, first);
  });
  return sums.jet(threshold_, cloud_speed_);
}

Jet AnisotropicField::jet(const Vec3& x) const {
  return jet_by<KernelSums>(x);
}

Jet AnisotropicField::first_order_jet(const Vec3& x) const {
  return jet_by<FirstOrderKernelSums>(x);
}

std::optional<Vec3> AnisotropicField::material_velocity(const Vec3& x) const {
  if (std::optional<Vec3> fitted = pattern_.material_velocity(x); fitted || cloud_speed_ > 0) return fitted;
  Vec3 sum = Vec3::Zero();
  double weights = 0;
  visit_hits(x, [&](std::span<const std::uint32_t> indices) {
    for (const std::uint32_t k : indices) {
      SymmetricMatrix shape;
      for (int ab = 0; ab < 6; ++ab) shape[ab] = shape_[ab][k];
      const Vec3 d = x - center(k);
      const double phi = weight_[k] * std::pow(1 - d.dot(full(shape) * d), 3);
      sum += phi * source_[k].material;
      weights += phi;
    }
  });
  return weights > 0 ? std::optional<Vec3>(sum / weights) : std::nullopt;
}

ValueAndGradient AnisotropicField::value_and_gradient(const Vec3& x) const {
  // As ParticleField does: picking the hits first would cost more than evaluating the misses, where u = 0.
  using Lanes = KernelHits::Lanes;
  Lanes f = Lanes::Zero(), g[3]{Lanes::Zero(), Lanes::Zero(), Lanes::Zero()};
  const auto add = [&](std::uint32_t k, const auto& kept) {
    const auto load = [k](const std::vector<double>& values) { return Eigen::Map<const Lanes>(&values[k]); };
    const Lanes dx = x[0] - load(center_[0]), dy = x[1] - load(center_[1]), dz = x[2] - load(center_[2]);
    const Lanes xy = load(shape_[1]), xz = load(shape_[2]), yz = load(shape_[4]);
    const Lanes ex = load(shape_[0]) * dx + xy * dy + xz * dz, ey = xy * dx + load(shape_[3]) * dy + yz * dz,
                ez = xz * dx + yz * dy + load(shape_[5]) * dz;
    const Lanes u = kept((1 - (dx * ex + dy * ey + dz * ez)).max(0.0));
    const Lanes w_u2 = load(weight_) * u * u, b1 = -6 * w_u2;
    f += w_u2 * u;
    g[0] += b1 * ex;
    g[1] += b1 * ey;
    g[2] += b1 * ez;
  };
  grid_.ranges_near(x, reach_,
                    [&](std::uint32_t begin, std::uint32_t end) { add_in_fours(begin, end, add); });
  return {f.sum() - threshold_, Vec3(g[0].sum(), g[1].sum(), g[2].sum())};
}

/// Whether f may be positive within the kernel's box: f <= sum_j w_j - T there, over the kernels whose boxes
/// meet it, itself included.
bool AnisotropicField::may_have_surface(std::size_t k) const {
  double sum = 0;
  const Vec3 c = center(k), half = source_[k].extent;
  grid_.ranges_near(c, half.maxCoeff() + reach_, [&](std::uint32_t begin, std::uint32_t end) {
    for (std::size_t q = begin; q < end && sum < threshold_; ++q)
      if (((center(q) - c).cwiseAbs().array() < (half + source_[q].extent).array()).all())
        sum += std::max(weight_[q], 0.0);
  });
  return sum >= threshold_;
}

std::optional<std::vector<std::array<int, 3>>> AnisotropicField::occupied_cubes(const SampledField& lattice,
                                                                                int cells) const {
  std::vector<char> counts(source_.size());
  parallel_for(counts.size(), [&](std::size_t k) { counts[k] = may_have_surface(k); });
  LatticeCubes cubes(lattice, cells);
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k]) cubes.add(center(k), source_[k].extent);
  return std::move(cubes).ascending();
}

void AnisotropicField::sample(SampledField& samples) const {
  const auto& dims = samples.dims;
  samples.value.resize(static_cast<std::size_t>(dims[0]) * dims[1] * dims[2]);
  const Vec3 half = 0.5 * samples.spacing * Vec3(dims[0] - 1, dims[1] - 1, dims[2] - 1),
             middle = samples.origin +
                      samples.spacing * Vec3(samples.first_column, samples.first_row, samples.first_plane) +
                      half;
  const double reach = half.maxCoeff() + reach_, inverse_spacing = 1 / samples.spacing,
               spacing2 = samples.spacing * samples.spacing;
  const auto fill_slab = [&](std::size_t s) {
    FieldSlab slab(samples, static_cast<int>(s));
    grid_.ranges_near(middle, reach, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k) {
        const Vec3 at = inverse_spacing * (center(k) - samples.origin),
                   extent = inverse_spacing * source_[k].extent;
        if (!slab.reached(at[2], extent[2])) continue;
        SymmetricMatrix shape;
        for (int ab = 0; ab < 6; ++ab) shape[ab] = spacing2 * shape_[ab][k];
        slab.add(at, shape, extent, weight_[k]);
      }
    });
    slab.write(threshold_, samples.value);
  };
  parallel_for(static_cast<std::size_t>(FieldSlab::count(samples)), fill_slab, 1);
}

}  // namespace kappaflow
