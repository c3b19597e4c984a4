#include "solver/viscosity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "solver/rigid_balance.h"

namespace kappaflow {
namespace {

// Share of what gravity adds in a step below which no error matters, however slow the liquid is.
constexpr double kLeastShare = 0.1;
// The velocities' last bits: no solve can be better.
constexpr double kRoundings = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());
// Of r . M^-1 r: when it has fallen so far, r is computed anew, for its recursion is in single precision.
constexpr double kReliable = 1e-7;

// 1 / the square of the least eigenvalue of M^-1 A: |e| <= |z| / that eigenvalue.
constexpr double kSlowest = 30;

double dot(const Vec4f& a, const Vec4f& b) {
  return static_cast<double>(a.dot(b));
}

}  // namespace

ViscositySolver::ViscositySolver(const FluidOptions& options)
    : forces_(options),
      preconditioner_(options.spacing),
      gravity_(options.gravity.norm()),
      tolerance_(options.viscosity_tolerance),
      max_iterations_(options.max_viscosity_iterations) {}

void ViscositySolver::apply(const FluidParticles& particles, const NeighbourLists& lists,
                            const WallSums& walls, float time_step, const std::vector<Vec4f>& u,
                            std::vector<Vec4f>& result) const {
  result.resize(u.size());
  parallel_for(u.size(), [&](std::size_t i) {
    result[i] = u[i] + time_step * forces_.resistance(i, particles, lists, walls, u);
  });
}

/// Sums over the particles that are solved for.
struct ViscositySolver::Squares {
  double count = 0, change = 0, speed = 0;  // of 1, |v - v*|^2, |v|^2

  friend Squares operator+(const Squares& a, const Squares& b) {
    return {a.count + b.count, a.change + b.change, a.speed + b.speed};
  }
};

/// The sum of squared errors that is tolerated.
double ViscositySolver::tolerated(const Squares& squares, double time_step) const {
  const double fall = squares.count * std::pow(gravity_ * time_step, 2);
  double scale = std::min(squares.change, squares.speed);
  if (fall > 0) scale = std::clamp(scale, kLeastShare * kLeastShare * fall, fall);
  return tolerance_ * tolerance_ * scale + kRoundings * kRoundings * squares.speed;
}

/// What M^-1 r = z says of the error e = A^-1 r, r its residual.
struct ViscositySolver::Progress {
  double energy = 0;  // r . z
  double square = 0;  // z . z

  friend Progress operator+(const Progress& a, const Progress& b) {
    return {a.energy + b.energy, a.square + b.square};
  }
  /// About the most that e . e can be. A >= 1, so that e . e <= e . A e = r . A^-1 r. Of stiff liquid, whose
  /// last bits alone have much energy, the other bound is the smaller one.
  double error() const { return energy > 0 ? std::min(energy, kSlowest * square) : 0; }
};

/// One solve. Every vector but v is zero for the particles that take no part. The steps are those of the
/// preconditioned conjugate gradients (Hestenes & Stiefel, "Methods of conjugate gradients for solving linear
/// systems", 1952).
class ViscositySolver::ConjugateGradients {
 public:
  ConjugateGradients(const ViscositySolver& solver, RigidMultigrid& preconditioner, FluidParticles& particles,
                     const NeighbourLists& lists, const WallSums& walls, float time_step)
      : forces_(solver.forces_),
        preconditioner_(preconditioner),
        particles_(particles),
        lists_(lists),
        walls_(walls),
        time_step_(time_step),
        solution_(particles.viscous_velocity),
        residual_(particles.scratch[0]),
        direction_(particles.scratch[1]),
        image_(particles.scratch[2]) {
    for (auto* vector : {&residual_, &direction_, &image_}) vector->resize(particles.size());
    parallel_for(particles.size(), [this](std::size_t i) {
      if (!preconditioner_.takes_part(i)) solution_[i] = particles_.velocity[i];
    });
  }

  /// r = v* - v - dt (L v - f), p = 0.
  Squares restart() {
    return sum(Squares(), [this](std::size_t i) {
      residual_[i].setZero();
      direction_[i].setZero();
      if (!preconditioner_.takes_part(i)) return Squares();
      const Vec4f friction = forces_.resistance(i, particles_, lists_, walls_, solution_) -
                             forces_.wall_drive(i, particles_, walls_);
      residual_[i] = particles_.velocity[i] - solution_[i] - time_step_ * friction;
      return squares(i);
    });
  }

  /// z = M^-1 r.
  Progress precondition() {
    preconditioner_.solve(particles_, residual_);
    return sum(Progress(), [this](std::size_t i) {
      image_[i] = preconditioner_.times(particles_, residual_, i);
      return Progress{dot(image_[i], residual_[i]), dot(image_[i], image_[i])};
    });
  }

  /// p = z + factor p.
  void turn(float factor) {
    parallel_for(particles_.size(),
                 [&](std::size_t i) { direction_[i] = image_[i] + factor * direction_[i]; });
  }

  /// q = A p; returns p . q.
  double curvature() {
    return sum(0.0, [this](std::size_t i) {
      image_[i].setZero();
      if (!preconditioner_.takes_part(i)) return 0.0;
      image_[i] = direction_[i] + time_step_ * forces_.resistance(i, particles_, lists_, walls_, direction_);
      return dot(direction_[i], image_[i]);
    });
  }

  /// v += length p, r -= length q.
  Squares advance(float length) {
    return sum(Squares(), [this, length](std::size_t i) {
      solution_[i] += length * direction_[i];
      residual_[i] -= length * image_[i];
      return squares(i);
    });
  }

 private:
  Squares squares(std::size_t i) const {
    if (!preconditioner_.takes_part(i)) return {};
    const Vec4f change = solution_[i] - particles_.velocity[i];
    return {1, dot(change, change), dot(solution_[i], solution_[i])};
  }
  template <class T, class Value>
  T sum(const T& zero, const Value& value) const {
    return parallel_sum(particles_.size(), zero, value);
  }

  const ViscousForces& forces_;
  RigidMultigrid& preconditioner_;
  FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_;
  std::vector<Vec4f>&solution_, &residual_, &direction_, &image_;  // v, r, p, z and then q
};

ViscositySolve ViscositySolver::solve(FluidParticles& particles, const NeighbourLists& lists,
                                      const WallSums& walls, float time_step) {
  if (forces_.none()) return {};
  preconditioner_.build(forces_, particles, lists, walls, time_step);
  ConjugateGradients step(*this, preconditioner_, particles, lists, walls, time_step);
  Squares squares = step.restart();
  ViscositySolve result;
  double first = 0, last = 0;
  for (bool restarted = true;; ++result.iterations) {
    Progress now = step.precondition();
    if (now.energy < kReliable * first) {
      squares = step.restart();
      now = step.precondition();
      restarted = true;
    }
    const double target = tolerated(squares, static_cast<double>(time_step));
    result.error = std::sqrt(now.error() / std::max(target, std::numeric_limits<double>::min()));
    if (!(result.error > 1) || result.iterations == max_iterations_) break;
    step.turn(restarted ? 0.0f : static_cast<float>(now.energy / last));
    if (restarted) first = now.energy;
    last = now.energy;
    restarted = false;
    squares = step.advance(static_cast<float>(now.energy / step.curvature()));
  }
  balance_momentum(preconditioner_, forces_, particles, lists, walls, time_step, particles.viscous_velocity);
  particles.velocity = particles.viscous_velocity;
  return result;
}

}  // namespace kappaflow
