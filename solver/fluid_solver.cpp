#include "solver/fluid_solver.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "solver/fluid_state.h"
#include "solver/start.h"
#include "solver/wall_bodies.h"

namespace kappaflow {
namespace {

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

}  // namespace

FluidSolver::FluidSolver(const FluidOptions& options, std::span<const Vec3> position,
                         std::span<const Vec3> velocity, std::span<const SolidWall> walls,
                         std::span<const std::uint8_t> fluid, std::span<const int> source,
                         std::span<const double> temperature, std::span<const RigidBody> bodies,
                         Ranks* ranks) {
  check_options(options);
  check_start(position, velocity, fluid, options.fluids(), source, all_solids(walls, bodies));
  check_temperatures(temperature, position.size(), options);
  const std::vector<WallHeat> rules = options.heat ? options.heat->walls : std::vector<WallHeat>();
  RigidBodies rigid(bodies, options.density, options.spacing);
  BodyCollisions collisions(rigid, rigid.none() ? std::span<const SolidWall>() : walls, options.spacing);
  state_ = std::make_unique<State>(
      options, Walls(wall_bodies(walls, rules, bodies, options.spacing), static_cast<float>(options.spacing)),
      std::move(rigid), std::move(collisions), ranks);
  FluidParticles& particles = state_->particles;
  if (ranks == nullptr || ranks->rank() == 0) {
    particles = particles_at_start(position, velocity, fluid, source);
    if (options.heat) particles.temperature.assign(position.size(), options.heat->temperature);
    std::ranges::copy(temperature, particles.temperature.begin());
  }
  particles.halo = state_->halo.get();
  particles.mass_of_fluid = masses_of_fluids(options);
  state_->together({RankTask::make}, [this] { state_->begin(); });
}

FluidSolver::~FluidSolver() = default;
FluidSolver::FluidSolver(FluidSolver&&) noexcept = default;
FluidSolver& FluidSolver::operator=(FluidSolver&&) noexcept = default;

FluidStep FluidSolver::step(double time_left) {
  FluidStep done;
  state_->together({RankTask::step, time_left}, [&] { done = state_->step(time_left); });
  return done;
}

/// Puts the first particles where they belong.
void FluidSolver::State::begin() {
  if (ranks != nullptr) ranks->broadcast(bytes_in(std::span(&particles.made, 1)));
  emit(0);
  if (sum_of_ranks(particles, particles.size()) == 0)
    throw InvalidInput("fluid: there are no particles at the start");
  fastest = fastest_speed(particles);
  place_bodies();
  find_neighbours();
  sum_walls();
  settle();
}

FluidStep FluidSolver::State::step(double time_left) {
  collected = Collected::nothing;
  FluidStep done;
  Stopwatch watch;
  const double exchanged = exchange_seconds();
  done.time_step = time_step(time_left);
  const float dt = static_cast<float>(done.time_step);

  emitters.lead(particles, time, done.time_step);
  const HeatSolve heated = heat.solve(particles, neighbours, wall_sums, dt);
  check_heat(heated);
  done.heat_iterations = heated.iterations;
  done.heat_from_walls = heated.from_walls;
  done.heat_from_air = heated.from_air;
  const Vec3 pull = gravity.mean(time, time + done.time_step);
  accelerate(particles, padded(pull), dt);
  bodies.accelerate(pull, done.time_step);
  tension.apply(particles, neighbours, dt);
  pressure.apply_last(particles, neighbours, dt, coupling());
  if (isotropic.needed()) isotropic.apply(particles, neighbours, wall_sums, dt);
  const bool thick = viscous_pressure.needed();
  if (thick) viscous_pressure.spread(particles, neighbours, dt);
  done.seconds.forces = watch.lap();
  const ViscositySolve viscous = viscosity.solve(particles, neighbours, wall_sums, dt, time, moved_bodies());
  done.viscosity_iterations = viscous.iterations;
  done.viscosity_error = viscous.error;
  done.seconds.viscosity = watch.lap();
  const PressureSolve density =
      pressure.correct_density(particles, neighbours, wall_sums, dt,
                               thick ? particles.least_pressure : std::span<const float>(), coupling());
  if (thick) {
    viscous_pressure.measure(particles, neighbours, wall_sums);
    viscous_pressure.correct(particles);
  }
  done.density_iterations = density.iterations;
  done.seconds.density = watch.lap();
  check_finite();
  check_viscosity(viscous);
  check_pressure(density, "density", options.density_tolerance);
  check_motion(done.time_step);
  move(particles, dt);
  particles.drop_ghosts();
  outflows.take(particles);
  emit(time + done.time_step);
  if (!bodies.none()) collisions.move(bodies, time, done.time_step);
  walls.move_to(time + done.time_step);
  place_bodies();
  find_neighbours();
  done.seconds.neighbours = watch.lap();
  sum_walls();
  done.seconds.walls = watch.lap();
  done.density_iterations += relieve_squeezed();
  done.seconds.density += watch.lap();
  const PressureSolve divergence =
      pressure.correct_divergence(particles, neighbours, wall_sums, dt, coupling());
  place_bodies();
  done.divergence_iterations = divergence.iterations;
  done.seconds.divergence = watch.lap();
  check_finite();
  check_pressure(divergence, "divergence", options.divergence_tolerance);

  time += done.time_step;
  ++steps;
  measure(done);
  done.seconds.step = watch.seconds();
  own_seconds += done.seconds.step - (exchange_seconds() - exchanged);
  return done;
}

void FluidSolver::State::emit(double until) {
  emitters.emit(particles, until);
  heat.add_new(particles);
}

void FluidSolver::State::find_neighbours() {
  if (halo != nullptr) {
    particles.drop_ghosts();
    halo->migrate(particles);
  }
  search.sort(particles);
  if (halo != nullptr) halo->find_ghosts(particles);
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
  check_positions();
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

void FluidSolver::State::measure(FluidStep& done) {
  done.density_error_mean = mean_compression(particles);
  done.density_error_max = static_cast<double>(largest_compression(particles));
  done.fastest = fastest = fastest_speed(particles);
}

}  // namespace kappaflow
