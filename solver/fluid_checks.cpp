// How long a step may be, and when the solver cannot go on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "solver/fluid_state.h"
#include "solver/time_step.h"

namespace kappaflow {
namespace {

// Errors at the last iteration beyond which the flow is no longer the liquid's.
constexpr double kFailedViscosity = 10;   // of what is tolerated [1]
constexpr double kFailedPressure = 0.01;  // mean compression [1]
// Motion in one step beyond which the flow explodes [spacings]; cfl, at most 1, is what was planned.
constexpr double kFailedMotion = 10;

/// The particle with the largest value, NaN being larger than all; the one with the lowest id if several have
/// it.
template <class Value>
FailedParticle worst_particle(const FluidParticles& particles, const Value& value) {
  struct Candidate {
    float value;
    FailedParticle particle;
  };
  const auto worse = [](const Candidate& a, const Candidate& b) {
    return std::pair(a.value, -a.particle.id) < std::pair(b.value, -b.particle.id) ? b : a;
  };
  Candidate worst{-std::numeric_limits<float>::infinity(), {}};
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const float v = value(i);
    const Vec3 velocity = particles.velocity[i].head<3>().cast<double>();
    const FailedParticle own{particles.id[i], particles.position[i].head<3>().cast<double>(),
                             velocity.norm()};
    const Candidate one{std::isnan(v) ? std::numeric_limits<float>::infinity() : v, own};
    worst = i == 0 ? one : worse(worst, one);
  }
  if (particles.halo != nullptr) worst = particles.halo->ranks().combined(worst, worse);
  return worst.particle;
}

FailedParticle fastest_particle(const FluidParticles& particles) {
  return worst_particle(particles, [&](std::size_t i) { return particles.velocity[i].squaredNorm(); });
}

FailedParticle densest_particle(const FluidParticles& particles) {
  return worst_particle(particles, [&](std::size_t i) { return particles.density[i]; });
}

}  // namespace

double fastest_speed(const FluidParticles& particles) {
  const float square = parallel_max(particles.size(), 0.0f, [&](std::size_t i) {
    const float s = particles.velocity[i].squaredNorm();
    return std::isfinite(s) ? s : std::numeric_limits<float>::infinity();
  });
  return std::sqrt(static_cast<double>(max_of_ranks(particles, square)));
}

double mean_compression(const FluidParticles& particles) {
  const std::size_t n = particles.size(), total = total_size(particles);
  const auto compression = [&](std::size_t i) { return std::max(particles.density[i] - 1, 0.0f); };
  if (total == 0) return 0;
  return sum_of_ranks(particles, parallel_sum<double>(n, 0, compression)) / static_cast<double>(total);
}

float largest_compression(const FluidParticles& particles) {
  const float own =
      parallel_max(particles.size(), 0.0f, [&](std::size_t i) { return particles.density[i] - 1; });
  return max_of_ranks(particles, own);
}

double FluidSolver::State::time_step(double time_left) const {
  if (!(time_left > 0))
    throw InvalidInput(fmt::format("time left for the step = {} s; must be above 0", time_left));
  const double end = time + options.max_time_step;
  const double needed = cfl_time_step(std::max({fastest, emitters.fastest(time, end), walls.fastest()}),
                                      gravity.largest(time, end), options.cfl * options.spacing);
  if (needed < options.min_time_step) {
    check_finite();
    throw SolverFailure(
        time, steps + 1, fastest_particle(particles),
        fmt::format("such a speed needs a time step of {:.3g} s, below min_time_step = {:.3g} s; lower cfl "
                    "or max_time_step if the flow explodes, else min_time_step",
                    needed, options.min_time_step));
  }
  const double capillary =
      capillary_time_step(options.surface_tension, options.least_density(), options.spacing);
  return fit_time_step(std::min({needed, capillary, options.max_time_step}), time_left);
}

void FluidSolver::State::check_finite() const {
  if (!std::isfinite(bodies.fastest()))
    throw SolverFailure(
        time, steps + 1, fastest_particle(particles),
        fmt::format("the velocity of a rigid body is not finite; try a smaller cfl (now {}) or "
                    "max_time_step (now {} s)",
                    options.cfl, options.max_time_step));
  if (std::isfinite(fastest_speed(particles))) return;
  throw SolverFailure(
      time, steps + 1, fastest_particle(particles),
      fmt::format("its velocity is not finite; try a smaller cfl (now {}) or max_time_step (now {} s)",
                  options.cfl, options.max_time_step));
}

/// After particles were moved apart.
void FluidSolver::State::check_positions() const {
  const auto lost = [this](std::size_t i) {
    return particles.position[i].head<3>().allFinite() ? 0.0f : 1.0f;
  };
  if (max_of_ranks(particles, parallel_max(particles.size(), 0.0f, lost)) == 0) return;
  throw SolverFailure(
      time, steps + 1, worst_particle(particles, lost),
      fmt::format("its position is not finite; try a smaller cfl (now {}) or max_time_step (now {} s)",
                  options.cfl, options.max_time_step));
}

void FluidSolver::State::check_heat(const HeatSolve& solve) const {
  if (!solve.sound) {
    const FailedParticle coldest = worst_particle(
        particles, [&](std::size_t i) { return static_cast<float>(-particles.temperature[i]); });
    throw SolverFailure(
        time, steps + 1, coldest,
        "its temperature is not above 0 K, or not finite; take less heat by a wall's heat_flux, or "
        "lower max_time_step");
  }
  if (solve.error <= 1) return;
  throw SolverFailure(
      time, steps + 1, fastest_particle(particles),
      fmt::format("the heat solver's error is {:.2g} times what is tolerated after {} iterations; lower "
                  "max_time_step (now {} s)",
                  solve.error, solve.iterations, options.max_time_step));
}

void FluidSolver::State::check_viscosity(const ViscositySolve& solve) const {
  if (solve.error <= kFailedViscosity) return;
  throw SolverFailure(
      time, steps + 1, fastest_particle(particles),
      fmt::format("the viscosity solver's error is {:.2g} times what is tolerated after {} iterations; raise "
                  "max_viscosity_iterations (now {}) or viscosity_tolerance (now {}), or lower max_time_step "
                  "(now {} s)",
                  solve.error, solve.iterations, options.max_viscosity_iterations,
                  options.viscosity_tolerance, options.max_time_step));
}

void FluidSolver::State::check_pressure(const PressureSolve& solve, const char* solver,
                                        double tolerance) const {
  if (solve.mean_error <= std::max(kFailedPressure, tolerance)) return;
  throw SolverFailure(
      time, steps + 1, densest_particle(particles),
      fmt::format("the {} solver is at a mean error of {:.2g} after {} iterations; raise "
                  "max_pressure_iterations (now {}), or lower cfl (now {}) or max_time_step (now {} s)",
                  solver, solve.mean_error, solve.iterations, options.max_pressure_iterations, options.cfl,
                  options.max_time_step));
}

void FluidSolver::State::check_motion(double time_step) const {
  const double speed = std::max(fastest_speed(particles), bodies.fastest()),
               spacings = speed * time_step / options.spacing;
  if (spacings <= kFailedMotion) return;
  throw SolverFailure(
      time, steps + 1, fastest_particle(particles),
      fmt::format("the flow explodes: it would move by {:.3g} spacings in one step; lower max_time_step (now "
                  "{} s) or cfl (now {})",
                  spacings, options.max_time_step, options.cfl));
}

}  // namespace kappaflow
