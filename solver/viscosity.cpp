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
    : support_(static_cast<float>(2 * options.spacing)),
      tolerance_(options.viscosity_tolerance),
      max_iterations_(options.max_viscosity_iterations) {
  std::vector<double> kinematic{options.kinematic_viscosity};
  kinematic.insert(kinematic.end(), options.more_viscosities.begin(), options.more_viscosities.end());
  const double slip = options.slip_length / (kContactDistance * options.spacing);
  for (const double a : kinematic) {
    viscosity_.push_back(static_cast<float>(a));
    wall_viscosity_.push_back(static_cast<float>(a / (1 + slip)));
    for (const double b : kinematic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0.0f);
  }
}

Vec4f ViscositySolver::apply_to(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                const WallSums& walls, float time_step, const std::vector<Vec4f>& u) const {
  const Vec4f xi = particles.position[i], ui = u[i];
  const bool several = viscosity_.size() > 1;
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position.data(), block.index.data());
    const WideVec uj = gather(u.data(), block.index.data());
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide r2 = x * x + y * y + z * z;
    Wide scale =
        viscosity_weight<Wide>(r2, support_) * (x * (ui[0] - uj.x) + y * (ui[1] - uj.y) + z * (ui[2] - uj.z));
    if (several) scale *= pair_viscosity(i, block, particles);
    sum_x += scale * x;
    sum_y += scale * y;
    sum_z += scale * z;
  }
  Vec4f sum(sum_x.sum(), sum_y.sum(), sum_z.sum(), 0);
  if (!several) sum *= viscosity_.front();
  if (walls.touches(i)) sum += wall_viscosity_[particles.fluid[i]] * walls.drag(i, ui);
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
  inverse_diagonal_.resize(particles.size());
  const bool several = viscosity_.size() > 1;
  parallel_for(inverse_diagonal_.size(), [&](std::size_t i) {
    const Vec4f xi = particles.position[i];
    Wide xx = Wide::Zero(), yy = xx, zz = xx, xy = xx, xz = xx, yz = xx;
    for (const PairBlock& block : lists.of(i)) {
      const WideVec xj = gather(particles.position.data(), block.index.data());
      const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
      const Wide r2 = x * x + y * y + z * z;
      Wide weight = viscosity_weight<Wide>(r2, support_);
      if (several) weight *= pair_viscosity(i, block, particles);
      xx += weight * x * x;
      yy += weight * y * y;
      zz += weight * z * z;
      xy += weight * x * y;
      xz += weight * x * z;
      yz += weight * y * z;
    }
    Mat43f block = Mat43f::Zero();
    block.topRows<3>() << xx.sum(), xy.sum(), xz.sum(), xy.sum(), yy.sum(), yz.sum(), xz.sum(), yz.sum(),
        zz.sum();
    if (!several) block *= viscosity_.front();
    if (walls.touches(i))
      for (int c = 0; c < 3; ++c)
        block.col(c) += wall_viscosity_[particles.fluid[i]] * walls.drag(i, Vec4f::Unit(c));
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

  // (I + dt L) change = -dt (L v* - f), where f is the drive of moving walls: the right-hand side does not
  // see a common velocity, so neither does the tolerance.
  const auto sum = [n](const auto& value) { return parallel_sum<double>(n, 0.0, value); };
  const double target = tolerance_ * tolerance_ * sum([&](std::size_t i) {
                          residual_[i] =
                              velocity[i] - apply_to(i, particles, lists, walls, time_step, velocity);
                          if (walls.touches(i))
                            residual_[i] += time_step * wall_viscosity_[particles.fluid[i]] * walls.drive(i);
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
  // change + residual = -dt (L (v* + change) - f) is a sum of pair forces: momentum is conserved whatever the
  // tolerance.
  parallel_for(n, [&](std::size_t i) { velocity[i] += change[i] + residual_[i]; });
  return iterations;
}

}  // namespace kappaflow
