#include "solver/viscosity.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

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

/// One solve of A change = b, with A = I + dt L and b = -dt (L v* - f), where f is the drive of moving walls:
/// the right-hand side does not see a common velocity, so neither does the tolerance. Every vector is zero
/// for the particles that an emitter leads. The steps are those of the preconditioned conjugate gradients
/// (Hestenes & Stiefel, "Methods of conjugate gradients for solving linear systems", 1952), M^-1 being the
/// inverses of A's 3x3 diagonal blocks.
class ViscositySolver::ConjugateGradients {
 public:
  ConjugateGradients(const ViscositySolver& solver, FluidParticles& particles, const NeighbourLists& lists,
                     const WallSums& walls, float time_step)
      : solver_(solver),
        particles_(particles),
        lists_(lists),
        walls_(walls),
        time_step_(time_step),
        change_(particles.viscous_change),
        residual_(particles.scratch[0]),
        direction_(particles.scratch[1]),
        image_(particles.scratch[2]) {
    residual_.resize(particles.size());
    image_.resize(particles.size());
    // resize() leaves Eigen's vectors uninitialised, and 0 * NaN is NaN
    direction_.assign(particles.size(), Vec4f::Zero());
  }

  /// r = b; returns r . r.
  double start_from_nothing() {
    return sum([this](std::size_t i) {
      residual_[i] = particles_.velocity[i] - A(particles_.velocity, i);
      if (walls_.touches(i))
        residual_[i] += time_step_ * solver_.wall_viscosity_[particles_.fluid[i]] * walls_.drive(i);
      keep_led(residual_, i);
      return dot(residual_[i], residual_[i]);
    });
  }

  /// r = b - A change, of what the last step has left in it; returns r . r.
  double start_from_last_change() {
    return sum([this](std::size_t i) {
      residual_[i] -= A(change_, i);
      keep_led(residual_, i);
      return dot(residual_[i], residual_[i]);
    });
  }

  /// r . M^-1 r.
  double energy() const {
    return sum([this](std::size_t i) { return dot(preconditioned(i), residual_[i]); });
  }

  /// p = M^-1 r + factor p.
  void turn(float factor) {
    parallel_for(particles_.size(),
                 [&](std::size_t i) { direction_[i] = preconditioned(i) + factor * direction_[i]; });
  }

  /// q = A p; returns p . q.
  double curvature() {
    return sum([this](std::size_t i) {
      image_[i] = A(direction_, i);
      keep_led(image_, i);
      return dot(direction_[i], image_[i]);
    });
  }

  /// change += length p, r -= length q; returns r . r.
  double advance(float length) {
    return sum([this, length](std::size_t i) {
      change_[i] += length * direction_[i];
      residual_[i] -= length * image_[i];
      return dot(residual_[i], residual_[i]);
    });
  }

  /// v = v* + change + r, which is v* - dt (L (v* + change) - f), a sum of pair forces: momentum is conserved
  /// whatever the tolerance.
  void apply_change() {
    parallel_for(particles_.size(),
                 [this](std::size_t i) { particles_.velocity[i] += change_[i] + residual_[i]; });
  }

 private:
  template <class Value>
  double sum(const Value& value) const {
    return parallel_sum<double>(particles_.size(), 0.0, value);
  }
  Vec4f A(const std::vector<Vec4f>& u, std::size_t i) const {
    return solver_.apply_to(i, particles_, lists_, walls_, time_step_, u);
  }
  Vec4f preconditioned(std::size_t i) const { return solver_.inverse_diagonal_[i] * residual_[i]; }
  void keep_led(std::vector<Vec4f>& vector, std::size_t i) const {
    if (particles_.led_by[i] != 0) vector[i].setZero();
  }

  const ViscositySolver& solver_;
  FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_;
  std::vector<Vec4f>&change_, &residual_, &direction_, &image_;  // change, r, p, q
};

ViscositySolve ViscositySolver::solve(FluidParticles& particles, const NeighbourLists& lists,
                                      const WallSums& walls, float time_step) {
  if (std::ranges::all_of(pair_viscosity_, [](float viscosity) { return viscosity == 0; })) return {};
  invert_diagonal(particles, lists, walls, time_step);
  ConjugateGradients step(*this, particles, lists, walls, time_step);
  const double first = step.start_from_nothing(), target = tolerance_ * tolerance_ * first;
  double square = step.start_from_last_change(), energy = 0;
  int iterations = 0;
  for (; square > target && iterations < max_iterations_; ++iterations) {
    const double last_energy = std::exchange(energy, step.energy());
    step.turn(iterations == 0 ? 0.0f : static_cast<float>(energy / last_energy));
    square = step.advance(static_cast<float>(energy / step.curvature()));
  }
  step.apply_change();
  return {iterations, first > 0 ? std::sqrt(square / first) : 0};
}

}  // namespace kappaflow
