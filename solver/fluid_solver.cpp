#include "solver/fluid_solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/saved_state.h"
#include "core/stopwatch.h"
#include "solver/body_collisions.h"
#include "solver/boundary.h"
#include "solver/emitter.h"
#include "solver/heat.h"
#include "solver/isotropic_pressure.h"
#include "solver/neighbours.h"
#include "solver/outflow.h"
#include "solver/pressure.h"
#include "solver/rigid_bodies.h"
#include "solver/start.h"
#include "solver/surface_tension.h"
#include "solver/time_step.h"
#include "solver/viscosity.h"
#include "solver/viscous_pressure.h"
#include "solver/wall_bodies.h"

namespace kappaflow {
namespace {

// Errors at the last iteration beyond which the flow is no longer the liquid's.
constexpr double kFailedViscosity = 10;   // of what is tolerated [1]
constexpr double kFailedPressure = 0.01;  // mean compression [1]
// Motion in one step beyond which the flow explodes [spacings]; cfl, at most 1, is what was planned.
constexpr double kFailedMotion = 10;
// Compression of a particle beyond which particles are moved apart after a step.
constexpr float kSqueezed = 0.05f;

void accelerate(FluidParticles& particles, const Vec4f& acceleration, float time_step) {
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] == 0) particles.velocity[i] += time_step * acceleration;
  });
}

void move(FluidParticles& particles, float time_step) {
  parallel_for(particles.size(),
               [&](std::size_t i) { particles.position[i] += time_step * particles.velocity[i]; });
}

/// Largest speed [m/s]; infinite when the velocity of any particle is not finite.
double fastest_speed(const FluidParticles& particles) {
  const float square = parallel_max(particles.size(), 0.0f, [&](std::size_t i) {
    const float s = particles.velocity[i].squaredNorm();
    return std::isfinite(s) ? s : std::numeric_limits<float>::infinity();
  });
  return std::sqrt(static_cast<double>(square));
}

/// The particle with the largest value, NaN being larger than all; the one with the lowest id if several have
/// it.
template <class Value>
FailedParticle worst_particle(const FluidParticles& particles, const Value& value) {
  std::size_t worst = 0;
  const auto rank = [&](std::size_t i) {
    const float v = value(i);
    return std::pair(std::isnan(v) ? std::numeric_limits<float>::infinity() : v,
                     -static_cast<std::int64_t>(particles.id[i]));
  };
  for (std::size_t i = 1; i < particles.size(); ++i)
    if (rank(i) > rank(worst)) worst = i;
  const Vec3 velocity = particles.velocity[worst].head<3>().cast<double>();
  return {particles.id[worst], particles.position[worst].head<3>().cast<double>(), velocity.norm()};
}

FailedParticle fastest_particle(const FluidParticles& particles) {
  return worst_particle(particles, [&](std::size_t i) { return particles.velocity[i].squaredNorm(); });
}

FailedParticle densest_particle(const FluidParticles& particles) {
  return worst_particle(particles, [&](std::size_t i) { return particles.density[i]; });
}

/// Mean of max(rho/rho0 - 1, 0).
double mean_compression(const FluidParticles& particles) {
  const std::size_t n = particles.size();
  const auto compression = [&](std::size_t i) { return std::max(particles.density[i] - 1, 0.0f); };
  return n == 0 ? 0 : parallel_sum<double>(n, 0, compression) / static_cast<double>(n);
}

/// Largest rho/rho0 - 1, or 0.
float largest_compression(const FluidParticles& particles) {
  return parallel_max(particles.size(), 0.0f, [&](std::size_t i) { return particles.density[i] - 1; });
}

/// Where the particles are, by ascending id.
std::vector<std::uint32_t> order_by_id(const FluidParticles& particles) {
  constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(particles.source.size(), kGone);
  for (std::size_t i = 0; i < particles.size(); ++i) place[particles.id[i]] = static_cast<std::uint32_t>(i);
  std::erase(place, kGone);
  return place;
}

/// value(i) of the particles by ascending id.
template <class T, class Value>
std::vector<T> values_by_id(const FluidParticles& particles, const Value& value) {
  std::vector<T> result;
  if (particles.size() == particles.source.size()) {  // none is gone
    result.resize(particles.size());
    for (std::size_t i = 0; i < particles.size(); ++i) result[particles.id[i]] = value(i);
    return result;
  }
  result.reserve(particles.size());
  for (const std::uint32_t i : order_by_id(particles)) result.push_back(value(i));
  return result;
}

}  // namespace

struct FluidSolver::State {
  State(const FluidOptions& o, Walls w, RigidBodies b, BodyCollisions c)
      : options(o),
        search(static_cast<float>(o.spacing)),
        walls(std::move(w)),
        bodies(std::move(b)),
        collisions(std::move(c)),
        viscosity(o),
        pressure(o),
        viscous_pressure(o),
        tension(o),
        isotropic(o),
        heat(o),
        emitters(o),
        outflows(o),
        gravity(o.gravity_in_time()) {}

  void emit(double until);
  void find_neighbours();
  void sum_walls();
  void place_bodies();
  /// What takes part in pressure and viscosity, if anything.
  RigidBodies* moved_bodies() { return bodies.none() ? nullptr : &bodies; }
  Coupling coupling() { return {moved_bodies(), &wall_sums}; }
  int move_apart(double tolerance);
  void settle();
  int relieve_squeezed();
  double time_step(double time_left) const;
  void check_finite() const;
  void check_heat(const HeatSolve& solve) const;
  void check_viscosity(const ViscositySolve& solve) const;
  void check_pressure(const PressureSolve& solve, const char* solver, double tolerance) const;
  void check_motion(double time_step) const;
  void measure(FluidStep& done);
  template <class Archive>
  void serialize(Archive& archive);

  FluidOptions options;
  NeighbourSearch search;
  Walls walls;
  RigidBodies bodies;
  BodyCollisions collisions;
  ViscositySolver viscosity;
  PressureSolver pressure;
  ViscousPressure viscous_pressure;
  SurfaceTension tension;
  IsotropicPressure isotropic;
  HeatSolver heat;
  Emitters emitters;
  Outflows outflows;
  TimeTable<Vec3> gravity;

  double time = 0;
  std::size_t steps = 0;
  double fastest = 0;  // speed now
  FluidParticles particles;
  NeighbourLists neighbours;
  WallSums wall_sums;
};

FluidSolver::FluidSolver(const FluidOptions& options, std::span<const Vec3> position,
                         std::span<const Vec3> velocity, std::span<const SolidWall> walls,
                         std::span<const std::uint8_t> fluid, std::span<const int> source,
                         std::span<const double> temperature, std::span<const RigidBody> bodies) {
  check_options(options);
  check_start(position, velocity, fluid, options.fluids(), source, all_solids(walls, bodies));
  check_temperatures(temperature, position.size(), options);
  const std::vector<WallHeat> rules = options.heat ? options.heat->walls : std::vector<WallHeat>();
  RigidBodies rigid(bodies, options.density, options.spacing);
  BodyCollisions collisions(rigid, rigid.none() ? std::span<const SolidWall>() : walls, options.spacing);
  state_ = std::make_unique<State>(
      options, Walls(wall_bodies(walls, rules, bodies, options.spacing), static_cast<float>(options.spacing)),
      std::move(rigid), std::move(collisions));
  state_->particles = particles_at_start(position, velocity, fluid, source);
  state_->particles.mass_of_fluid = masses_of_fluids(options);
  if (options.heat) state_->particles.temperature.assign(position.size(), options.heat->temperature);
  std::ranges::copy(temperature, state_->particles.temperature.begin());
  state_->emit(0);
  if (size() == 0) throw InvalidInput("fluid: there are no particles at the start");
  state_->fastest = fastest_speed(state_->particles);
  state_->place_bodies();
  state_->find_neighbours();
  state_->sum_walls();
  state_->settle();
}

FluidSolver::~FluidSolver() = default;
FluidSolver::FluidSolver(FluidSolver&&) noexcept = default;
FluidSolver& FluidSolver::operator=(FluidSolver&&) noexcept = default;

FluidStep FluidSolver::step(double time_left) {
  State& s = *state_;
  FluidStep done;
  Stopwatch watch;
  done.time_step = s.time_step(time_left);
  const float dt = static_cast<float>(done.time_step);

  s.emitters.lead(s.particles, s.time, done.time_step);
  const HeatSolve heat = s.heat.solve(s.particles, s.neighbours, s.wall_sums, dt);
  s.check_heat(heat);
  done.heat_iterations = heat.iterations;
  done.heat_from_walls = heat.from_walls;
  done.heat_from_air = heat.from_air;
  const Vec3 gravity = s.gravity.mean(s.time, s.time + done.time_step);
  accelerate(s.particles, padded(gravity), dt);
  s.bodies.accelerate(gravity, done.time_step);
  s.tension.apply(s.particles, s.neighbours, dt);
  s.pressure.apply_last(s.particles, s.neighbours, dt, s.coupling());
  if (s.isotropic.needed()) s.isotropic.apply(s.particles, s.neighbours, s.wall_sums, dt);
  const bool thick = s.viscous_pressure.needed();
  if (thick) s.viscous_pressure.spread(s.particles, s.neighbours, dt);
  done.seconds.forces = watch.lap();
  const ViscositySolve viscosity =
      s.viscosity.solve(s.particles, s.neighbours, s.wall_sums, dt, s.time, s.moved_bodies());
  done.viscosity_iterations = viscosity.iterations;
  done.viscosity_error = viscosity.error;
  done.seconds.viscosity = watch.lap();
  const PressureSolve density =
      s.pressure.correct_density(s.particles, s.neighbours, s.wall_sums, dt,
                                 thick ? s.particles.least_pressure : std::span<const float>(), s.coupling());
  if (thick) {
    s.viscous_pressure.measure(s.particles, s.neighbours, s.wall_sums);
    s.viscous_pressure.correct(s.particles);
  }
  done.density_iterations = density.iterations;
  done.seconds.density = watch.lap();
  s.check_finite();
  s.check_viscosity(viscosity);
  s.check_pressure(density, "density", s.options.density_tolerance);
  s.check_motion(done.time_step);
  move(s.particles, dt);
  s.outflows.take(s.particles);
  s.emit(s.time + done.time_step);
  if (!s.bodies.none()) s.collisions.move(s.bodies, s.time, done.time_step);
  s.walls.move_to(s.time + done.time_step);
  s.place_bodies();
  s.find_neighbours();
  done.seconds.neighbours = watch.lap();
  s.sum_walls();
  done.seconds.walls = watch.lap();
  done.density_iterations += s.relieve_squeezed();
  done.seconds.density += watch.lap();
  const PressureSolve divergence =
      s.pressure.correct_divergence(s.particles, s.neighbours, s.wall_sums, dt, s.coupling());
  s.place_bodies();
  done.divergence_iterations = divergence.iterations;
  done.seconds.divergence = watch.lap();
  s.check_finite();
  s.check_pressure(divergence, "divergence", s.options.divergence_tolerance);

  s.time += done.time_step;
  ++s.steps;
  s.measure(done);
  done.seconds.step = watch.seconds();
  return done;
}

void FluidSolver::State::emit(double until) {
  emitters.emit(particles, until);
  heat.add_new(particles);
}

void FluidSolver::State::find_neighbours() {
  search.sort(particles);
  search.find(particles, neighbours);
}

void FluidSolver::State::sum_walls() {
  walls.add_to(particles, wall_sums);
  bodies.find_contacts(particles, walls, wall_sums);
}

/// Tells the walls where the bodies are.
void FluidSolver::State::place_bodies() {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyState state = bodies.state(b);
    walls.place(b, state.pose, state.velocity);
  }
}

// Returns the iterations it took.
int FluidSolver::State::move_apart(double tolerance) {
  const PressureSolve solve = pressure.move_apart(particles, neighbours, tolerance);
  find_neighbours();
  sum_walls();
  return solve.iterations;
}

// Particles that start too close to each other, or to the irregular particles of a wall, are moved apart. The
// first step would do so too, but with velocities, which would last, and be the larger the shorter the step.
void FluidSolver::State::settle() {
  constexpr int kRounds = 20;
  for (int round = 0; round < kRounds && mean_compression(particles) > options.density_tolerance; ++round)
    move_apart(options.density_tolerance);
}

// The density at the end of a step is predicted to first order. Next to a wall, and where liquid meets liquid
// at speed, it curves so much over a step that single particles end far too close. The next step would push
// them away with a speed that is none of the flow's. Returns the iterations it took.
int FluidSolver::State::relieve_squeezed() {
  constexpr int kRounds = 3;
  int iterations = 0;
  for (int round = 0; round < kRounds && largest_compression(particles) > kSqueezed; ++round)
    iterations += move_apart(1);  // until no single one is squeezed, whatever the mean
  return iterations;
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

void FluidSolver::State::measure(FluidStep& done) {
  done.density_error_mean = mean_compression(particles);
  done.density_error_max = static_cast<double>(largest_compression(particles));
  done.fastest = fastest = fastest_speed(particles);
}

template <class Archive>
void FluidSolver::State::serialize(Archive& archive) {
  archive(time, steps, fastest, particles, emitters, bodies);
  if constexpr (Archive::is_loading::value) {
    walls.move_to(time);
    place_bodies();
    find_neighbours();
    sum_walls();
  }
}

template <class Archive>
void FluidSolver::serialize(Archive& archive) {
  archive(*state_);
}
template void FluidSolver::serialize(StateWriter&);
template void FluidSolver::serialize(StateReader&);

SolverMemory FluidSolver::memory() const {
  const State& s = *state_;
  return {s.particles.bytes() + s.search.bytes() + s.neighbours.bytes() + s.wall_sums.bytes() +
              s.viscosity.bytes() + s.heat.bytes() + s.bodies.bytes(),
          s.walls.bytes(), s.walls.size()};
}

double FluidSolver::time() const {
  return state_->time;
}
std::size_t FluidSolver::steps() const {
  return state_->steps;
}
std::size_t FluidSolver::size() const {
  return state_->particles.size();
}

std::vector<std::size_t> FluidSolver::taken() const {
  return state_->outflows.taken(state_->particles);
}

std::vector<BodyState> FluidSolver::bodies() const {
  std::vector<BodyState> result;
  for (std::size_t b = 0; b < state_->bodies.size(); ++b) result.push_back(state_->bodies.state(b));
  return result;
}

Particles FluidSolver::particles() const {
  const FluidParticles& p = state_->particles;
  const std::vector<std::uint32_t> order = order_by_id(p);
  Particles result{state_->time, std::vector<std::int64_t>(size()), std::vector<Vec3>(size()),
                   std::vector<Vec3>(size())};
  for (std::size_t k = 0; k < size(); ++k) {
    const std::uint32_t i = order[k];
    result.id[k] = p.id[i];
    result.position[k] = p.position[i].head<3>().cast<double>();
    result.velocity[k] = p.velocity[i].head<3>().cast<double>();
  }
  return result;
}

std::vector<float> FluidSolver::densities() const {
  const FluidParticles& p = state_->particles;
  return values_by_id<float>(p, [&](std::size_t i) {
    return static_cast<float>(state_->options.rest_density(p.fluid[i])) * p.density[i];
  });
}

std::vector<float> FluidSolver::pressures() const {
  const FluidParticles& p = state_->particles;
  return values_by_id<float>(p, [&](std::size_t i) {
    return static_cast<float>(state_->options.density) * p.density[i] * p.density[i] *
           (p.density_pressure[i] + p.divergence_pressure[i]);
  });
}

std::vector<std::uint8_t> FluidSolver::fluids() const {
  const FluidParticles& p = state_->particles;
  return values_by_id<std::uint8_t>(p, [&](std::size_t i) { return p.fluid[i]; });
}

std::vector<double> FluidSolver::temperatures() const {
  const FluidParticles& p = state_->particles;
  if (p.temperature.empty()) return {};
  return values_by_id<double>(p, [&](std::size_t i) { return p.temperature[i]; });
}

std::vector<int> FluidSolver::sources() const {
  const FluidParticles& p = state_->particles;
  return values_by_id<int>(p, [&](std::size_t i) { return p.source[p.id[i]]; });
}

}  // namespace kappaflow
