#include "solver/viscosity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

// Share of what gravity adds in a step below which no error matters, however slow the liquid is.
constexpr double kLeastShare = 0.1;
// The velocities' last bits: no solve can be better.
constexpr double kRoundings = 4 * static_cast<double>(std::numeric_limits<float>::epsilon());
// Of r . M^-1 r: when it has fallen so far, r is computed anew, for its recursion is in single precision.
constexpr double kReliable = 1e-7;

// Of the error: what a last step leaves of it that takes the length of the step before, without a product by
// A. Measured: 0.55 to 0.75.
constexpr double kLastLength = 0.7;

// 1 / the square of the least eigenvalue of M^-1 A: |e| <= |z| / that eigenvalue.
constexpr double kSlowest = 30;

double sum_of(const Vec4f& v) {
  return static_cast<double>(v.sum());
}

/// What M^-1 r = z says of the error e = A^-1 r, r its residual: energy r . z, square z . m z. About the most
/// that e . m e can be. A >= m, so that e . m e <= e . A e = r . A^-1 r. Of stiff liquid, whose last bits
/// alone have much energy, the other bound is the smaller one.
double squared_error(double energy, double square) {
  return std::min(std::abs(energy), kSlowest * square);  // no number if the energy is none
}

}  // namespace

ViscositySolver::ViscositySolver(const FluidOptions& options)
    : forces_(options),
      preconditioner_(options.spacing),
      gravity_(options.gravity_in_time()),
      tolerance_(options.viscosity_tolerance),
      max_iterations_(options.max_viscosity_iterations) {}

void ViscositySolver::apply(const FluidParticles& particles, const NeighbourLists& lists,
                            const WallSums& walls, float time_step, const std::vector<Vec4f>& u,
                            std::vector<Vec4f>& result) const {
  result.resize(u.size());
  parallel_for(u.size(), [&](std::size_t i) {
    result[i] = particles.mass(i) * u[i] + time_step * forces_.resistance(i, particles, lists, walls, u);
  });
}

/// Sums over the particles that are solved for.
struct ViscositySolver::Squares {
  double mass = 0, change = 0, speed = 0, block_energy = 0;  // of m, m |v - v*|^2, m |v|^2, r . D^-1 r

  friend Squares operator+(const Squares& a, const Squares& b) {
    return {a.mass + b.mass, a.change + b.change, a.speed + b.speed, a.block_energy + b.block_energy};
  }
};

/// The sum of squared errors that is tolerated. speed_of_fall: what gravity adds in the step [m/s].
double ViscositySolver::tolerated(const Squares& squares, double speed_of_fall) const {
  const double fall = squares.mass * std::pow(speed_of_fall, 2);
  double scale = std::min(squares.change, squares.speed);
  if (fall > 0) scale = std::clamp(scale, kLeastShare * kLeastShare * fall, fall);
  return tolerance_ * tolerance_ * scale + kRoundings * kRoundings * squares.speed;
}

/// One solve. p is zero for the particles that take no part. The steps are those of the preconditioned
/// conjugate gradients (Hestenes & Stiefel, "Methods of conjugate gradients for solving linear systems",
/// 1952). They go over the particles cell by cell: what is near stays in cache.
class ViscositySolver::ConjugateGradients {
 public:
  ConjugateGradients(const ViscositySolver& solver, RigidMultigrid& preconditioner, FluidParticles& particles,
                     const NeighbourLists& lists, const WallSums& walls, BodyDrag& bodies, float time_step)
      : forces_(solver.forces_),
        cells_(preconditioner),
        bodies_(bodies),
        particles_(particles),
        lists_(lists),
        walls_(walls),
        time_step_(time_step),
        acceleration_(particles.viscous_acceleration),
        solution_(particles.viscous_velocity),
        residual_(particles.scratch[0]),
        direction_(particles.scratch[1]),
        image_(particles.scratch[2]) {
    for (auto* vector : {&residual_, &direction_, &image_}) vector->resize(particles.size());
    cells_.find_weak(forces_, time_step);
    parallel_for(particles.size(), [this](std::size_t i) { start(i); });
  }

  /// Builds the preconditioner and finds the first residual.
  Squares begin() {
    bodies_.set_up();
    fill_ghosts(particles_, solution_);
    cells_.build(forces_, particles_, lists_, walls_, time_step_, solution_, image_);
    return find_residual();
  }

  /// Finds the residual anew.
  Squares restart() {
    for_rows(particles_, solution_, [this](std::size_t i) {
      image_[i] = forces_.resistance(i, particles_, lists_, walls_, solution_);
    });
    return find_residual();
  }

  /// p = z + factor p; returns z . m z.
  double turn(float factor) {
    return sum(0.0, [this, factor](std::size_t cell) {
      Vec4f squares = Vec4f::Zero();
      cells_.for_solutions(cell, particles_, residual_, [&](std::size_t i, const Vec4f& z) {
        direction_[i] = z + factor * direction_[i];
        squares += particles_.mass(i) * z.cwiseAbs2();
      });
      return sum_of(squares);
    });
  }

  /// q = A p; returns p . q. In the order of the lists of neighbours, most of what is read.
  double curvature() {
    const double of_liquid = sum_over_rows(
        particles_, direction_, 0.0,
        [this](std::size_t i) {
          image_[i] = particles_.mass(i) * direction_[i] +
                      time_step_ * forces_.resistance(i, particles_, lists_, walls_, direction_);
          return direction_[i].cwiseProduct(image_[i]).sum();
        },
        [](std::size_t, float product) { return static_cast<double>(product); });
    return sum_of_ranks(particles_, of_liquid) + bodies_.respond_to(direction_, image_);
  }

  /// v += length p, r -= length q.
  Squares advance(float length) {
    return sum(Squares(), [this, length](std::size_t cell) {
      cells_.for_particles(cell, [this, length](std::size_t i) {
        solution_[i] += length * direction_[i];
        residual_[i] -= length * image_[i];
      });
      return squares(cell);
    });
  }

  /// v += length p, and no more.
  void finish(float length) {
    cells_.for_cells([this, length](std::size_t cell) {
      cells_.for_particles(cell, [this, length](std::size_t i) { solution_[i] += length * direction_[i]; });
    });
  }

  /// What start() of the next step needs; v becomes that of the
  /// particles.
  void keep() {
    parallel_for(particles_.size(), [this](std::size_t i) {
      const Vec4f change = (solution_[i] - particles_.velocity[i]) / time_step_;
      acceleration_[i] = halved(change - widened(acceleration_[i]));
      particles_.velocity[i] = solution_[i];
    });
  }

 private:
  /// v begins as if it changed as it did in the last step. Until keep(), what it was stays as its difference
  /// from v*, over the step.
  void start(std::size_t i) {
    direction_[i].setZero();
    const Vec4f last = solution_[i], &now = particles_.velocity[i];
    const Vec4f change = time_step_ * widened(acceleration_[i]);
    const bool weak = cells_.is_weak(particles_.fluid[i]);
    solution_[i] = !forces_.act_on(i, particles_) ? now : weak ? Vec4f(now + change) : Vec4f(last + change);
    acceleration_[i] = weak ? Vec4h::Zero() : halved((last - now) / time_step_);
  }
  /// r = m (v* - v) - dt (L v - f) from q = L v.
  Squares find_residual() {
    bodies_.respond(solution_);
    return sum(Squares(), [this](std::size_t cell) {
      cells_.for_particles(cell, [this](std::size_t i) {
        const Vec4f friction = image_[i] - forces_.wall_drive(i, particles_, walls_);
        const Vec4f change = particles_.velocity[i] - solution_[i];
        residual_[i] = particles_.mass(i) * change - time_step_ * friction;
      });
      return squares(cell);
    });
  }
  /// Of v and r as they are in the cell; restricts r to it.
  Squares squares(std::size_t cell) {
    Vec4f change = Vec4f::Zero(), speed = change;
    double masses = 0;
    cells_.for_particles(cell, [&](std::size_t i) {
      const float m = particles_.mass(i);
      change += m * (solution_[i] - particles_.velocity[i]).cwiseAbs2();
      speed += m * solution_[i].cwiseAbs2();
      masses += static_cast<double>(m);
    });
    return {masses, sum_of(change), sum_of(speed), cells_.restrict_to(cell, particles_, residual_)};
  }
  template <class T, class Value>
  T sum(const T& zero, const Value& value) const {
    return sum_of_ranks(particles_, cells_.sum_over_cells(zero, value));
  }

  const ViscousForces& forces_;
  RigidMultigrid& cells_;
  BodyDrag& bodies_;
  FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_;
  std::vector<Vec4h>& acceleration_;
  std::vector<Vec4f>&solution_, &residual_, &direction_, &image_;  // v, r, p, q
};

/// The system of the viscosities as they are; result.iterations counts on.
void ViscositySolver::solve_system(ConjugateGradients& step, double speed_of_fall, ViscositySolve& result) {
  Squares squares = step.begin();
  const auto precondition = [&] { return squares.block_energy + preconditioner_.solve(); };
  double energy = precondition(), first = energy, last = 0;
  float length = 0;
  for (;; ++result.iterations) {
    const double square = step.turn(last > 0 ? static_cast<float>(energy / last) : 0.0f);
    const double target = tolerated(squares, speed_of_fall);
    const double left = (length > 0 ? kLastLength * kLastLength : 1) * squared_error(energy, square);
    result.error = std::sqrt(left / std::max(target, std::numeric_limits<double>::min()));
    if (!(result.error > 1) || result.iterations == max_iterations_) break;
    last = energy;
    length = static_cast<float>(energy / step.curvature());
    squares = step.advance(length);
    energy = precondition();
    if (energy < kReliable * first) {
      squares = step.restart();
      energy = first = precondition();
      last = 0;
      length = 0;
    }
  }
  step.finish(length);
  ++result.systems;
}

ViscositySolve ViscositySolver::solve(FluidParticles& particles, const NeighbourLists& lists, WallSums& walls,
                                      float time_step, double time, RigidBodies* bodies) {
  if (forces_.none() || total_size(particles) == 0) return {};
  const double dt = static_cast<double>(time_step);
  const double speed_of_fall = gravity_.mean(time, time + dt).norm() * dt;
  const auto find_viscosities = [&](bool again) {
    forces_.find_viscosities(particles, lists, walls, particles.viscous_velocity, again);
  };
  BodyDrag drag(forces_, bodies, particles, walls, time_step);
  if (forces_.vary()) find_viscosities(false);
  ConjugateGradients step(*this, preconditioner_, particles, lists, walls, drag, time_step);
  ViscositySolve result;
  solve_system(step, speed_of_fall, result);
  for (int before = -1; forces_.depend_on_flow() && result.iterations > before;) {
    before = result.iterations;
    drag.respond(particles.viscous_velocity);
    find_viscosities(true);
    solve_system(step, speed_of_fall, result);
  }
  drag.respond(particles.viscous_velocity);
  balance_.restore(preconditioner_, forces_, particles, lists, walls, drag, time_step,
                   particles.viscous_velocity);
  drag.respond(particles.viscous_velocity);
  step.keep();
  return result;
}

}  // namespace kappaflow
