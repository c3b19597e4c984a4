#include "surface/field/particle_weights.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/errors.h"
#include "core/nearest_points.h"
#include "core/quantile.h"
#include "surface/field/particle_field.h"

namespace kappaflow {

namespace {

/// sum_j w_j (1 - r_ij^2)^3 at each particle i, itself included.
std::vector<double> kernel_sums(std::span<const Vec3> position, std::span<const double> weight, double sigma,
                                std::span<const double> scale) {
  const std::size_t n = position.size();
  FieldParticles particles{.position = {position.begin(), position.end()},
                           .velocity = std::vector<Vec3>(n, Vec3::Zero()),
                           .sigma = support_radii(n, sigma, scale),
                           .weight = {weight.begin(), weight.end()},
                           .weight_rate = std::vector<double>(n, 0.0)};
  const ParticleField field(particles, 0.0, 0.0);
  std::vector<double> sum(n);
  parallel_for(n, [&](std::size_t i) { sum[i] = field.value_and_gradient(position[i]).f; });
  return sum;
}

/// Those that are counted.
std::vector<double> chosen(std::vector<double> values, std::span<const std::uint32_t> counted) {
  if (counted.empty()) return values;
  std::vector<double> result;
  for (const std::uint32_t i : counted) result.push_back(values[i]);
  return result;
}

/// Of particles of scale 1.
double median_nearest_distance(std::span<const Vec3> position, std::span<const double> scale,
                               std::span<const std::uint32_t> counted) {
  std::vector<double> squares = nearest_neighbour_squares(position);
  for (std::size_t i = 0; i < scale.size(); ++i) squares[i] /= scale[i] * scale[i];
  squares = chosen(std::move(squares), counted);
  return std::sqrt(upper_median(squares));
}

}  // namespace

std::vector<double> support_radii(std::size_t n, double sigma, std::span<const double> scale) {
  std::vector<double> radii(n, sigma);
  for (std::size_t i = 0; i < scale.size(); ++i) radii[i] *= scale[i];
  return radii;
}

std::vector<double> field_weights(std::span<const Vec3> position, double sigma, WeightRule rule,
                                  std::span<const double> scale) {
  std::vector<double> weight(position.size(), 1.0);
  if (rule == WeightRule::uniform) return weight;
  const std::vector<double> sum = kernel_sums(position, weight, sigma, scale);
  std::transform(sum.begin(), sum.end(), weight.begin(), [](double s) { return 1 / s; });
  return weight;
}

double half_median_threshold(std::span<const Vec3> position, std::span<const double> weight, double sigma,
                             std::span<const double> scale, std::span<const std::uint32_t> counted) {
  if (position.empty()) throw InvalidInput("a threshold from the particles needs at least one particle");
  std::vector<double> sum = chosen(kernel_sums(position, weight, sigma, scale), counted);
  const double lower = quantile(sum, 0.5), upper = upper_median(sum);
  return 0.25 * (lower + upper);
}

double particle_spacing(std::span<const Vec3> position, std::span<const double> scale,
                        std::span<const std::uint32_t> counted) {
  constexpr double kReach = 2.5, kShare = 0.9;                     // see the header
  constexpr double kKernelIntegral = 64 * std::numbers::pi / 315;  // of (1 - r^2)^3 over the unit ball
  if (position.size() < 2) throw InvalidInput("the spacing of particles takes at least two of them");
  const double nearest = median_nearest_distance(position, scale, counted);
  if (!(nearest > 0)) throw InvalidInput("half of the particles coincide with others");
  const double s = kReach * nearest;
  std::vector<double> sum =
      chosen(kernel_sums(position, std::vector<double>(position.size(), 1.0), s, scale), counted);
  return s * std::cbrt(kKernelIntegral / quantile(sum, kShare));
}

}  // namespace kappaflow
