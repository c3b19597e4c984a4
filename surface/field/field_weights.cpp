// Weights and threshold of Eq. 12 from the particles' places.
#include <algorithm>

#include "core/errors.h"
#include "surface/field/particle_field.h"

namespace kappaflow {

namespace {

/// sum_j w_j (1 - r_ij^2)^3 at each particle i, itself included.
std::vector<double> kernel_sums(std::span<const Vec3> position, std::span<const double> weight,
                                double sigma) {
  const std::size_t n = position.size();
  FieldParticles particles{.position = {position.begin(), position.end()},
                           .velocity = std::vector<Vec3>(n, Vec3::Zero()),
                           .sigma = std::vector<double>(n, sigma),
                           .weight = {weight.begin(), weight.end()},
                           .weight_rate = std::vector<double>(n, 0.0)};
  const ParticleField field(particles, 0.0, 0.0);
  std::vector<double> sum(n);
  parallel_for(n, [&](std::size_t i) { sum[i] = field.value_and_gradient(position[i]).f; });
  return sum;
}

}  // namespace

std::vector<double> field_weights(std::span<const Vec3> position, double sigma, WeightRule rule) {
  std::vector<double> weight(position.size(), 1.0);
  if (rule == WeightRule::uniform) return weight;
  const std::vector<double> sum = kernel_sums(position, weight, sigma);
  std::transform(sum.begin(), sum.end(), weight.begin(), [](double s) { return 1 / s; });
  return weight;
}

double half_median_threshold(std::span<const Vec3> position, std::span<const double> weight, double sigma) {
  if (position.empty()) throw InvalidInput("a threshold from the particles needs at least one particle");
  std::vector<double> sum = kernel_sums(position, weight, sigma);
  const std::size_t n = sum.size();
  std::sort(sum.begin(), sum.end());
  return 0.25 * (sum[(n - 1) / 2] + sum[n / 2]);
}

}  // namespace kappaflow
