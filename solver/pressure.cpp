#include "solver/pressure.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr float kRelaxation =
    0.5f;  // of the Jacobi steps; dt^2 D D^T scaled by its diagonal stays below 2 / this
constexpr int kMinIterations = 1;
constexpr float kLeastDiagonal = 1e-20f;  // below: no neighbours, no pressure
constexpr float kMaxCompression = 0.03f;  // of any particle when the solve stops [1]

/// What one iteration learns over all particles.
struct Progress {
  double error = 0;      // sum of the violated constraints
  double overshoot = 0;  // > 0: the extrapolation went against the gradient
  float max_error = 0;
};

Progress operator+(const Progress& a, const Progress& b) {
  return {a.error + b.error, a.overshoot + b.overshoot, std::max(a.max_error, b.max_error)};
}

}  // namespace

float density_rate(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                   const std::vector<Vec4f>& u) {
  Vec4f rate = u[i].cwiseProduct(particles.gradient_sum[i]);
  for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair)
    rate -= u[lists.index[pair]].cwiseProduct(lists.gradient[pair]);
  return rate.head<3>().sum();
}

Vec4f pressure_acceleration(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                            const std::vector<float>& kappa) {
  Vec4f sum = kappa[i] * particles.gradient_sum[i];
  for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair)
    sum += kappa[lists.index[pair]] * lists.gradient[pair];
  sum[3] = 0;
  return -sum;
}

PressureSolve PressureSolver::correct_density(FluidParticles& particles, const NeighbourLists& lists,
                                              float time_step) {
  source_.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    source_[i] = particles.density[i] - 1 + time_step * density_rate(i, particles, lists, particles.velocity);
  });
  return solve(particles, lists, time_step, density_tolerance_, particles.density_pressure);
}

PressureSolve PressureSolver::correct_divergence(FluidParticles& particles, const NeighbourLists& lists,
                                                 float time_step) {
  source_.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    source_[i] = std::min(particles.density[i] - 1, 0.0f) +
                 time_step * density_rate(i, particles, lists, particles.velocity);
  });
  return solve(particles, lists, time_step, divergence_tolerance_, particles.divergence_pressure);
}

PressureSolve PressureSolver::solve(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                                    double tolerance, std::vector<float>& kappa) {
  const std::size_t n = particles.size();
  acceleration_.resize(n);
  proposed_.resize(n);
  previous_ = kappa;
  const float square_step = time_step * time_step;
  float momentum = 1;
  for (int iterations = 0;; ++iterations) {
    parallel_for(
        n, [&](std::size_t i) { acceleration_[i] = pressure_acceleration(i, particles, lists, kappa); });
    const Progress progress = parallel_sum(n, Progress(), [&](std::size_t i) {
      const float violation = source_[i] + square_step * density_rate(i, particles, lists, acceleration_);
      const Vec4f g = particles.gradient_sum[i];
      const float diagonal = square_step * (g.squaredNorm() + particles.gradient_square_sum[i]);
      proposed_[i] =
          diagonal > kLeastDiagonal ? std::max(0.0f, kappa[i] + kRelaxation * violation / diagonal) : 0.0f;
      return Progress{std::max(violation, 0.0f),
                      (kappa[i] - proposed_[i]) * diagonal * (proposed_[i] - previous_[i]), violation};
    });
    const PressureSolve state{iterations, progress.error / static_cast<double>(n), progress.max_error};
    const bool converged = state.mean_error <= tolerance && state.max_error <= kMaxCompression;
    if ((converged && iterations >= kMinIterations) || iterations >= max_iterations_) {
      parallel_for(n, [&](std::size_t i) { particles.velocity[i] += time_step * acceleration_[i]; });
      return state;
    }
    if (progress.overshoot > 0) momentum = 1;
    const float next_momentum = 0.5f * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const float extrapolation = (momentum - 1) / next_momentum;
    momentum = next_momentum;
    parallel_for(n, [&](std::size_t i) {
      kappa[i] = std::max(0.0f, proposed_[i] + extrapolation * (proposed_[i] - previous_[i]));
      previous_[i] = proposed_[i];
    });
  }
}

}  // namespace kappaflow
