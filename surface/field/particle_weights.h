// Weights, threshold and spacing for Eq. 12 from the particles' places.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/named.h"
#include "core/types.h"

namespace kappaflow {

/// How the weights w_i of Eq. 12 are chosen.
enum class WeightRule {
  uniform,     ///< w_i = 1
  normalised,  ///< w_i = 1 / sum_j (1 - r_ij^2)^3, self included: about 1 inside, and 1 for a lone particle
};

/// As scenes and the command line have them.
inline constexpr Named<WeightRule> kWeightRules[] = {{"uniform", WeightRule::uniform},
                                                     {"normalised", WeightRule::normalised}};

/// Weights by `rule` for particles at `position` with support radii scale_i sigma [m]; scale:
/// Particles::scale, here and below.
std::vector<double> field_weights(std::span<const Vec3> position, double sigma, WeightRule rule,
                                  std::span<const double> scale = {});

/// Half the median over the particles of sum_j w_j (1 - r_ij^2)^3: the threshold that puts a flat surface in
/// the right place. Throws InvalidInput without particles. counted: the indices of those that the median is
/// of, here and below; empty: all.
double half_median_threshold(std::span<const Vec3> position, std::span<const double> weight, double sigma,
                             std::span<const double> scale = {}, std::span<const std::uint32_t> counted = {});

/// The spacing h of particles of scale 1 [m], one to h^3 inside the body: from the median m of the distances
/// to the nearest neighbour, and then from S = sum_j (1 - |x_ij|^2/s^2)^3 with s = 2.5 m, of which a body
/// without a surface has 64 pi/315 (s/h)^3. S is the one that a tenth of the particles exceed, as most of a
/// small body is near its surface. Exact to about 2 % in lattices and jittered bodies; a sheet's comes out a
/// quarter too large. Throws InvalidInput for fewer than two particles or where half of them coincide.
double particle_spacing(std::span<const Vec3> position, std::span<const double> scale = {},
                        std::span<const std::uint32_t> counted = {});

/// The support radii scale_i sigma of n particles [m].
std::vector<double> support_radii(std::size_t n, double sigma, std::span<const double> scale);

}  // namespace kappaflow
