#include "solver/viscosity.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace kappaflow {
namespace {

double dot(const Vec4f& a, const Vec4f& b) {
  return static_cast<double>(a.dot(b));
}

Vec4f operator*(const SymmetricMatrix& m, const Vec4f& v) {
  const auto& [xx, yy, zz, yz, xz, xy] = m;
  return {xx * v[0] + xy * v[1] + xz * v[2], xy * v[0] + yy * v[1] + yz * v[2],
          xz * v[0] + yz * v[1] + zz * v[2], 0};
}

}  // namespace

ViscositySolver::ViscositySolver(const FluidOptions& options)
    : support_(static_cast<float>(2 * options.spacing)),
      fluids_(1 + options.more_viscosities.size()),
      tolerance_(options.viscosity_tolerance),
      max_iterations_(options.max_viscosity_iterations) {
  std::vector<double> kinematic{options.kinematic_viscosity};
  kinematic.insert(kinematic.end(), options.more_viscosities.begin(), options.more_viscosities.end());
  const double contact = kContactDistance * options.spacing;
  for (const double viscosity : kinematic)
    wall_viscosity_.push_back(static_cast<float>(viscosity / (1 + options.slip_length / contact)));
  for (const double a : kinematic)
    for (const double b : kinematic)
      pair_viscosity_.push_back(a + b > 0 ? static_cast<float>(2 * a * b / (a + b)) : 0);
}

Wide ViscositySolver::pair_viscosity(std::uint8_t fluid, const FluidParticles& particles,
                                     const PairBlock& block) const {
  const float* with = pair_viscosity_.data() + fluid * fluids_;
  if (fluids_ == 1) return with[0] * block.present();
  Wide result;
  for (int k = 0; k < kWide; ++k)
    result[k] = with[particles.fluid[block.base + block.offset[static_cast<std::size_t>(k)]]];
  return result * block.present();
}

Vec4f ViscositySolver::apply_to(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                const WallSums& walls, float time_step, const std::vector<Vec4f>& u) const {
  const Vec4f &xi = particles.position[i], &ui = u[i];
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const WideVec uj = gather(u, block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide r2 = x * x + y * y + z * z;
    const Wide scale = pair_viscosity(particles.fluid[i], particles, block) *
                       viscosity_weight<Wide>(r2, support_) *
                       (x * (ui[0] - uj.x) + y * (ui[1] - uj.y) + z * (ui[2] - uj.z));
    sum_x += scale * x;
    sum_y += scale * y;
    sum_z += scale * z;
  }
  Vec4f sum(sum_x.sum(), sum_y.sum(), sum_z.sum(), 0);
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
  parallel_for(inverse_diagonal_.size(), [&](std::size_t i) {
    const Vec4f xi = particles.position[i];
    Wide xx = Wide::Zero(), yy = xx, zz = xx, xy = xx, xz = xx, yz = xx;
    for (const PairBlock& block : lists.of(i)) {
      const WideVec xj = gather(particles.position, block);
      const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
      const Wide r2 = x * x + y * y + z * z;
      const Wide weight =
          pair_viscosity(particles.fluid[i], particles, block) * viscosity_weight<Wide>(r2, support_);
      xx += weight * x * x;
      yy += weight * y * y;
      zz += weight * z * z;
      xy += weight * x * y;
      xz += weight * x * z;
      yz += weight * y * z;
    }
    Eigen::Matrix3f block;
    block << xx.sum(), xy.sum(), xz.sum(), xy.sum(), yy.sum(), yz.sum(), xz.sum(), yz.sum(), zz.sum();
    if (walls.touches(i))
      for (int c = 0; c < 3; ++c)
        block.col(c) += wall_viscosity_[particles.fluid[i]] * walls.drag(i, Vec4f::Unit(c)).head<3>();
    const Eigen::Matrix3f m = (Eigen::Matrix3f::Identity() + time_step * block).inverse();
    inverse_diagonal_[i] = {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)};
  });
}

ViscositySolve ViscositySolver::solve(FluidParticles& particles, const NeighbourLists& lists,
                                      const WallSums& walls, float time_step) {
  if (std::ranges::all_of(pair_viscosity_, [](float viscosity) { return viscosity == 0; })) return {};
  const std::size_t n = particles.size();
  auto &residual = particles.scratch[0], &direction = particles.scratch[1], &image = particles.scratch[2];
  residual.resize(n);
  image.resize(n);
  direction.assign(n, Vec4f::Zero());  // resize() leaves Eigen's vectors uninitialised, and 0 * NaN is NaN
  auto& velocity = particles.velocity;
  auto& change = particles.viscous_change;
  invert_diagonal(particles, lists, walls, time_step);

  // (I + dt L) change = -dt (L v* - f), where f is the drive of moving walls: the right-hand side does not
  // see a common velocity, so neither does the tolerance.
  const auto sum = [n](const auto& value) { return parallel_sum<double>(n, 0.0, value); };
  const double first = sum([&](std::size_t i) {
    residual[i] = velocity[i] - apply_to(i, particles, lists, walls, time_step, velocity);
    if (walls.touches(i)) residual[i] += time_step * wall_viscosity_[particles.fluid[i]] * walls.drive(i);
    if (particles.led_by[i] != 0) residual[i].setZero();
    return dot(residual[i], residual[i]);
  });
  const double target = tolerance_ * tolerance_ * first;
  double square = sum([&](std::size_t i) {
    residual[i] -= apply_to(i, particles, lists, walls, time_step, change);
    if (particles.led_by[i] != 0) residual[i].setZero();
    return dot(residual[i], residual[i]);
  });
  double energy = 0;
  int iterations = 0;
  while (square > target && iterations < max_iterations_) {
    const double last_energy = energy;
    energy = sum([&](std::size_t i) { return dot(inverse_diagonal_[i] * residual[i], residual[i]); });
    const float conjugate = iterations == 0 ? 0.0f : static_cast<float>(energy / last_energy);
    parallel_for(n, [&](std::size_t i) {
      direction[i] = inverse_diagonal_[i] * residual[i] + conjugate * direction[i];
    });
    const double curvature = sum([&](std::size_t i) {
      image[i] = apply_to(i, particles, lists, walls, time_step, direction);
      if (particles.led_by[i] != 0) image[i].setZero();
      return dot(direction[i], image[i]);
    });
    const float length = static_cast<float>(energy / curvature);
    square = sum([&](std::size_t i) {
      change[i] += length * direction[i];
      residual[i] -= length * image[i];
      return dot(residual[i], residual[i]);
    });
    ++iterations;
  }
  // change + residual = -dt (L (v* + change) - f) is a sum of pair forces: momentum is conserved whatever the
  // tolerance.
  parallel_for(n, [&](std::size_t i) { velocity[i] += change[i] + residual[i]; });
  return {iterations, first > 0 ? std::sqrt(square / first) : 0};
}

}  // namespace kappaflow
