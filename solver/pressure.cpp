#include "solver/pressure.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr int kMinIterations = 1;
constexpr float kMaxCompression = 0.01f;  // of any particle when the solve stops [1]
constexpr float kLeastDiagonal = 1e-20f;  // below: no neighbours, no pressure
constexpr float kFirstCurvature =
    2.5f;  // largest eigenvalue of the scaled system to begin with; liquid has up to 3

}  // namespace

/// What one iteration learns over all particles.
struct PressureSolver::Progress {
  double error = 0;      // sum of |min(kappa diagonal, -violation)|, in the units of the constraint
  double overshoot = 0;  // > 0: the extrapolation went against the gradient
  double moved = 0;      // squared length of the last move, scaled by the diagonal
  double curved = 0;     // the system's quadratic form of it
  float max_error = 0;

  friend Progress operator+(const Progress& a, const Progress& b) {
    return {a.error + b.error, a.overshoot + b.overshoot, a.moved + b.moved, a.curved + b.curved,
            std::max(a.max_error, b.max_error)};
  }
};

float density_rate(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                   const std::vector<Vec4f>& u) {
  Vec4f rate = u[i].cwiseProduct(particles.gradient_sum[i]);
  for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair)
    rate -= u[lists.index[pair]].cwiseProduct(lists.gradient[pair]);
  return rate.head<3>().sum();
}

Vec4f pressure_acceleration(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                            const std::vector<float>& kappa) {
  if (particles.led_by[i] != 0) return Vec4f::Zero();
  Vec4f sum = kappa[i] * particles.gradient_sum[i];
  for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair)
    sum += kappa[lists.index[pair]] * lists.gradient[pair];
  sum[3] = 0;
  return -sum;
}

void PressureSolver::apply_last(FluidParticles& particles, const NeighbourLists& lists, float time_step) {
  acceleration_.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    acceleration_[i] = pressure_acceleration(i, particles, lists, particles.density_pressure);
    particles.velocity[i] += time_step * acceleration_[i];
  });
}

PressureSolve PressureSolver::correct_density(FluidParticles& particles, const NeighbourLists& lists,
                                              float time_step) {
  const std::size_t n = particles.size();
  source_.resize(n);
  parallel_for(n, [&](std::size_t i) { particles.velocity[i] -= time_step * acceleration_[i]; });
  parallel_for(n, [&](std::size_t i) {
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

PressureSolver::Progress PressureSolver::iterate(const FluidParticles& particles, const NeighbourLists& lists,
                                                 float square_step, float relaxation,
                                                 const std::vector<float>& kappa) {
  const std::size_t n = particles.size();
  parallel_for(n,
               [&](std::size_t i) { acceleration_[i] = pressure_acceleration(i, particles, lists, kappa); });
  return parallel_sum(n, Progress(), [&](std::size_t i) {
    const float diagonal =
        square_step * (particles.gradient_sum[i].squaredNorm() + particles.gradient_square_sum[i]);
    const float violation = source_[i] + square_step * density_rate(i, particles, lists, acceleration_);
    const float jacobi = violation / std::max(diagonal, square_step * kLeastDiagonal);
    proposed_[i] =
        diagonal > square_step * kLeastDiagonal ? std::max(0.0f, kappa[i] + relaxation * jacobi) : 0.0f;
    const float move = kappa[i] - last_kappa_[i];
    const Progress progress{std::abs(std::max(-kappa[i] * diagonal, violation)),
                            (kappa[i] - proposed_[i]) * diagonal * (proposed_[i] - accepted_[i]),
                            move * diagonal * move, move * (last_violation_[i] - violation), violation};
    last_kappa_[i] = kappa[i];
    last_violation_[i] = violation;
    return progress;
  });
}

PressureSolve PressureSolver::solve(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                                    double tolerance, std::vector<float>& kappa) {
  const std::size_t n = particles.size();
  acceleration_.resize(n);
  proposed_.resize(n);
  last_violation_.resize(n);
  accepted_ = last_kappa_ = kappa;
  float momentum = 1, curvature = kFirstCurvature;
  for (int iterations = 0;; ++iterations) {
    const Progress progress = iterate(particles, lists, time_step * time_step, 1 / curvature, kappa);
    const double mean_error = progress.error / static_cast<double>(n);
    const bool converged = mean_error <= tolerance && progress.max_error <= kMaxCompression;
    if ((converged && iterations >= kMinIterations) || iterations == max_iterations_) {
      parallel_for(n, [&](std::size_t i) { particles.velocity[i] += time_step * acceleration_[i]; });
      return {iterations, mean_error, progress.max_error};
    }
    const bool too_long = progress.curved > curvature * progress.moved;
    if (too_long) curvature = 1.1f * static_cast<float>(progress.curved / progress.moved);
    if (too_long || progress.overshoot > 0) momentum = 1;
    const float next_momentum = 0.5f * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const float extrapolation = (momentum - 1) / next_momentum;
    momentum = next_momentum;
    parallel_for(n, [&](std::size_t i) {
      kappa[i] = std::max(0.0f, proposed_[i] + extrapolation * (proposed_[i] - accepted_[i]));
      accepted_[i] = proposed_[i];
    });
  }
}

}  // namespace kappaflow
