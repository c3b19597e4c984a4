#include "solver/viscosity.h"

#include <Eigen/LU>
#include <cmath>

#include "core/parallel.h"

namespace kappaflow {
namespace {

double dot(const Vec4f& a, const Vec4f& b) {
  return static_cast<double>(a.dot(b));
}

}  // namespace

ViscositySolver::ViscositySolver(const FluidOptions& options)
    : fluids_(1 + options.more_fluids.size()),
      tolerance_(options.viscosity_tolerance),
      max_iterations_(options.max_viscosity_iterations) {
  std::vector<double> kinematic{options.kinematic_viscosity};
  boundary_viscosity_.push_back(static_cast<float>(options.boundary_viscosity));
  for (const FluidViscosity& fluid : options.more_fluids) {
    kinematic.push_back(fluid.kinematic);
    boundary_viscosity_.push_back(static_cast<float>(fluid.boundary));
  }
  for (const double a : kinematic)
    for (const double b : kinematic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0);
}

Vec4f ViscositySolver::apply_to(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                const WallSums& walls, float time_step, const std::vector<Vec4f>& u) const {
  const float* viscosity = pair_viscosity(particles.fluid[i]);
  const bool one_fluid = fluids_ == 1;
  const Vec4f& ui = u[i];
  Vec4f sum = Vec4f::Zero();
  for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair) {
    const Vec4f g = lists.gradient[pair];
    const std::uint32_t j = lists.index[pair];
    const float nu = one_fluid ? viscosity[0] : viscosity[particles.fluid[j]];
    sum += (nu * g[3] * g.dot(ui - u[j])) * g;
  }
  if (walls.touches[i]) sum += boundary_viscosity_[particles.fluid[i]] * (walls.friction[i] * ui.head<3>());
  sum[3] = 0;
  return ui + time_step * sum;
}

void ViscositySolver::apply(const FluidParticles& particles, const NeighbourLists& lists,
                            const WallSums& walls, float time_step, const std::vector<Vec4f>& u,
                            std::vector<Vec4f>& result) const {
  result.resize(u.size());
  parallel_for(u.size(),
               [&](std::size_t i) { result[i] = apply_to(i, particles, lists, walls, time_step, u); });
}

void ViscositySolver::invert_diagonal(const FluidParticles& particles, const NeighbourLists& lists,
                                      const WallSums& walls, float time_step) {
  inverse_diagonal_.resize(lists.begin.size() - 1);
  parallel_for(inverse_diagonal_.size(), [&](std::size_t i) {
    Mat43f block = boundary_viscosity_[particles.fluid[i]] * walls.friction[i];
    const float* viscosity = pair_viscosity(particles.fluid[i]);
    for (std::size_t pair = lists.begin[i]; pair < lists.begin[i + 1]; ++pair) {
      const Vec4f g = lists.gradient[pair];
      const Vec4f scaled = viscosity[particles.fluid[lists.index[pair]]] * g[3] * g;
      for (int c = 0; c < 3; ++c) block.col(c) += g[c] * scaled;
    }
    const Eigen::Matrix3f diagonal = Eigen::Matrix3f::Identity() + time_step * block.topRows<3>();
    inverse_diagonal_[i].topRows<3>() = diagonal.inverse();
    inverse_diagonal_[i].row(3).setZero();
  });
}

int ViscositySolver::solve(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                           float time_step) {
  const std::size_t n = particles.size();
  for (auto* array : {&residual_, &image_, &preconditioned_}) array->resize(n);
  direction_.assign(n, Vec4f::Zero());  // resize() leaves Eigen's vectors uninitialised, and 0 * NaN is NaN
  auto& velocity = particles.velocity;
  auto& change = particles.viscous_change;
  invert_diagonal(particles, lists, walls, time_step);

  // (I + dt L) change = -dt L v*: the right-hand side does not see a common velocity, so neither does the
  // tolerance.
  const auto sum = [n](const auto& value) { return parallel_sum<double>(n, 0.0, value); };
  const double target = tolerance_ * tolerance_ * sum([&](std::size_t i) {
                          residual_[i] =
                              velocity[i] - apply_to(i, particles, lists, walls, time_step, velocity);
                          if (particles.led_by[i] != 0) residual_[i].setZero();
                          return dot(residual_[i], residual_[i]);
                        });
  double square = sum([&](std::size_t i) {
    residual_[i] -= apply_to(i, particles, lists, walls, time_step, change);
    if (particles.led_by[i] != 0) residual_[i].setZero();
    return dot(residual_[i], residual_[i]);
  });
  double energy = 0;
  int iterations = 0;
  while (square > target && iterations < max_iterations_) {
    const double last_energy = energy;
    energy = sum([&](std::size_t i) {
      preconditioned_[i] = inverse_diagonal_[i] * residual_[i].head<3>();
      return dot(preconditioned_[i], residual_[i]);
    });
    const float conjugate = iterations == 0 ? 0.0f : static_cast<float>(energy / last_energy);
    parallel_for(n, [&](std::size_t i) { direction_[i] = preconditioned_[i] + conjugate * direction_[i]; });
    const double curvature = sum([&](std::size_t i) {
      image_[i] = apply_to(i, particles, lists, walls, time_step, direction_);
      if (particles.led_by[i] != 0) image_[i].setZero();
      return dot(direction_[i], image_[i]);
    });
    const float length = static_cast<float>(energy / curvature);
    square = sum([&](std::size_t i) {
      change[i] += length * direction_[i];
      residual_[i] -= length * image_[i];
      return dot(residual_[i], residual_[i]);
    });
    ++iterations;
  }
  // change + residual = -dt L (v* + change) is a sum of pair forces: momentum is conserved whatever the
  // tolerance.
  parallel_for(n, [&](std::size_t i) { velocity[i] += change[i] + residual_[i]; });
  return iterations;
}

}  // namespace kappaflow
