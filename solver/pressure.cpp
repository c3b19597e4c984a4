#include "solver/pressure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/lanes.h"

namespace kappaflow {
namespace {

// One more than one in the divergence solve: what it leaves of a deep column's motion, of one sign all over,
// is what the next density solves see as pressure that comes and goes.
constexpr int kMinIterations = 1, kMinDivergenceIterations = 2;
constexpr float kMaxCompression = 0.01f;  // of any particle when the solve stops [1]
constexpr float kLeastDiagonal = 1e-20f;  // below: no neighbours, no pressure
constexpr float kFirstCurvature =
    2.5f;  // largest eigenvalue of the scaled system to begin with; liquid has up to 3

// What the solves keep in FluidParticles::scratch.
std::vector<Vec4f>& accelerations(FluidParticles& particles) {
  return particles.scratch[0];
}
/// The left-hand side of the constraint without pressure.
std::vector<float>& sources(FluidParticles& particles) {
  return particles.scalar_scratch;
}
/// Four numbers a particle: kappa after this iteration and the last, before extrapolation; kappa and the
/// constraint's violation that the last iteration saw. Before the first: D of the accelerations that the
/// pressure begins with.
enum Iterate { kProposed, kAccepted, kSeenKappa, kSeenViolation, kFirstRate = kProposed };
std::vector<Vec4f>& iterates(FluidParticles& particles) {
  return particles.scratch[1];
}

void accelerate_by_pressure(FluidParticles& particles, const NeighbourLists& lists, const Coupling& bodies) {
  auto& acceleration = accelerations(particles);
  KappaOf kappa{particles.position};
  for_rows(particles, kappa,
           [&](std::size_t i) { acceleration[i] = pressure_acceleration(i, particles, lists); });
  bodies.find_push(particles);
}

/// Multiplies the pressure by what minimises the problem along it, where the whole of it does the work that
/// its particles need: kappa^T source = dt^2 a^T M a. Sweeps reach one neighbour further each and take many
/// to change the pressure of a whole column; this needs none. Returns the factor.
float fit_scale(FluidParticles& particles, float square_step, const Coupling& bodies) {
  auto& acceleration = accelerations(particles);
  const auto& source = sources(particles);
  const std::size_t n = particles.size();
  const double of_liquid = parallel_sum<double>(n, 0, [&](std::size_t i) {
    return static_cast<double>(particles.mass(i) * acceleration[i].squaredNorm());
  });
  const double square = sum_of_ranks(particles, of_liquid) + bodies.push_square();
  if (!(square > 0)) return 1;
  const double own_needed = parallel_sum<double>(n, 0, [&](std::size_t i) {
    return static_cast<double>(particles.position[i][3]) * static_cast<double>(source[i]);
  });
  const double needed = sum_of_ranks(particles, own_needed);
  const float scale = static_cast<float>(std::max(0.0, needed / (static_cast<double>(square_step) * square)));
  parallel_for(n, [&](std::size_t i) {
    particles.position[i][3] *= scale;
    acceleration[i] *= scale;
  });
  bodies.scale_push(scale);
  return scale;
}

/// Takes over the pressure that a solve has found.
void accept(FluidParticles& particles, float time_step, std::vector<float>& kappa, const Coupling& bodies) {
  const auto& acceleration = accelerations(particles);
  parallel_for(particles.size(), [&](std::size_t i) {
    particles.velocity[i] += time_step * acceleration[i];
    kappa[i] = particles.position[i][3];
  });
  bodies.apply_push(time_step);
}

/// Lets the pair loops see kappa and computes its accelerations.
void start_from(const std::vector<float>& kappa, FluidParticles& particles, const NeighbourLists& lists,
                const Coupling& bodies) {
  const std::size_t n = particles.size();
  accelerations(particles).resize(n);
  parallel_for(n, [&](std::size_t i) { particles.position[i][3] = kappa[i]; });
  accelerate_by_pressure(particles, lists, bodies);
}

/// D u and D v of one particle.
std::array<float, 2> both_rates(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                const std::vector<Vec4f>& u, const std::vector<Vec4f>& v) {
  const Vec4f xi = particles.position[i];
  Wide sum_u = Wide::Zero(), sum_v = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const Wide factor = lists.factor(block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const WideVec uj = gather(u, block);
    sum_u += factor * (x * uj.x + y * uj.y + z * uj.z);
    const WideVec vj = gather(v, block);
    sum_v += factor * (x * vj.x + y * vj.y + z * vj.z);
  }
  const auto own = [&](const Vec4f& w) { return w.cwiseProduct(particles.gradient_sum[i]).head<3>().sum(); };
  return {own(u[i]) - sum_u.sum(), own(v[i]) - sum_v.sum()};
}

/// Fills sources() with base(i, D v, D a) plus what the velocities and walls compress in a step, and finds
/// the first rates, D a, which come of the same loop over pairs.
template <class Base>
void find_sources(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                  float time_step, const Coupling& bodies, const Base& base) {
  auto& source = sources(particles);
  auto& iterate = iterates(particles);
  source.resize(particles.size());
  iterate.resize(particles.size());
  fill_ghosts(particles, particles.velocity);
  for_rows(particles, accelerations(particles), [&](std::size_t i) {
    const auto [rate, first] = both_rates(i, particles, lists, particles.velocity, accelerations(particles));
    source[i] = base(i, rate, first) + time_step * (rate + walls.density_rate(i));
    iterate[i][kFirstRate] = first + bodies.push_rate(i, particles);
  });
}

/// The least kappa of a particle.
float bound_of(std::span<const float> least, std::size_t i) {
  return least.empty() ? 0.0f : least[i];
}

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
  const Vec4f xi = particles.position[i];
  Wide sum = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const WideVec uj = gather(u, block);
    sum += lists.factor(block) * ((xi[0] - xj.x) * uj.x + (xi[1] - xj.y) * uj.y + (xi[2] - xj.z) * uj.z);
  }
  return u[i].cwiseProduct(particles.gradient_sum[i]).head<3>().sum() - sum.sum();
}

Vec4f pressure_acceleration(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists) {
  if (particles.led_by[i] != 0) return Vec4f::Zero();
  const Vec4f xi = particles.position[i];
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const Wide scale = lists.factor(block) * xj.w;
    sum_x += scale * (xi[0] - xj.x);
    sum_y += scale * (xi[1] - xj.y);
    sum_z += scale * (xi[2] - xj.z);
  }
  return (xi[3] * particles.gradient_sum[i] + sums(sum_x, sum_y, sum_z)) / -particles.mass(i);
}

void PressureSolver::apply_last(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                                const Coupling& bodies) {
  start_from(particles.density_pressure, particles, lists, bodies);
  const auto& acceleration = accelerations(particles);
  parallel_for(particles.size(),
               [&](std::size_t i) { particles.velocity[i] += time_step * acceleration[i]; });
  bodies.apply_push(time_step);
}

PressureSolve PressureSolver::correct_density(FluidParticles& particles, const NeighbourLists& lists,
                                              const WallSums& walls, float time_step,
                                              std::span<const float> least, const Coupling& bodies) {
  const std::size_t n = particles.size();
  start_from(particles.density_pressure, particles, lists, bodies);
  const auto& acceleration = accelerations(particles);
  parallel_for(n, [&](std::size_t i) { particles.velocity[i] -= time_step * acceleration[i]; });
  bodies.apply_push(-time_step);
  bodies.drive(particles);
  auto& rates = compression_rates(particles);
  if (!least.empty()) rates.resize(n);
  find_sources(particles, lists, walls, time_step, bodies, [&](std::size_t i, float rate, float of_pressure) {
    if (!least.empty()) rates[i] = {rate + time_step * of_pressure, 0, 0, 0};
    return particles.density[i] - 1;
  });
  const PressureSolve done =
      solve(particles, lists, time_step, density_tolerance_, kMinIterations, least, bodies);
  accept(particles, time_step, particles.density_pressure, bodies);
  return done;
}

PressureSolve PressureSolver::correct_divergence(FluidParticles& particles, const NeighbourLists& lists,
                                                 const WallSums& walls, float time_step,
                                                 const Coupling& bodies) {
  start_from(particles.divergence_pressure, particles, lists, bodies);
  bodies.drive(particles);
  find_sources(particles, lists, walls, time_step, bodies,
               [&](std::size_t i, float, float) { return std::min(particles.density[i] - 1, 0.0f); });
  const PressureSolve done =
      solve(particles, lists, time_step, divergence_tolerance_, kMinDivergenceIterations, {}, bodies);
  accept(particles, time_step, particles.divergence_pressure, bodies);
  return done;
}

PressureSolve PressureSolver::move_apart(FluidParticles& particles, const NeighbourLists& lists,
                                         double tolerance) {
  const std::size_t n = particles.size();
  auto& acceleration = accelerations(particles);
  auto& source = sources(particles);
  acceleration.assign(particles.position.size(), Vec4f::Zero());
  source.resize(n);
  iterates(particles).assign(n, Vec4f::Zero());
  parallel_for(particles.position.size(), [&](std::size_t i) { particles.position[i][3] = 0; });
  parallel_for(n, [&](std::size_t i) { source[i] = particles.density[i] - 1; });
  const PressureSolve done = solve(particles, lists, 1, tolerance, kMinIterations, {}, {});
  parallel_for(n, [&](std::size_t i) { particles.position[i] += acceleration[i]; });
  return done;
}

PressureSolver::Progress PressureSolver::iterate(FluidParticles& particles, const NeighbourLists& lists,
                                                 float square_step, float relaxation,
                                                 std::span<const float> least, const Coupling& bodies,
                                                 bool first) {
  auto& acceleration = accelerations(particles);
  const auto& source = sources(particles);
  auto& iterate = iterates(particles);
  const auto progress = [&](std::size_t i, float rate) {
    const float diagonal = square_step * (particles.gradient_sum[i].squaredNorm() / particles.mass(i) +
                                          particles.gradient_square_sum[i] + bodies.push_diagonal(i));
    const float kappa = particles.position[i][3], bound = bound_of(least, i);
    const Vec4f last = iterate[i];
    const float violation = source[i] + square_step * rate;
    const float jacobi = violation / std::max(diagonal, square_step * kLeastDiagonal);
    const float proposed =
        diagonal > square_step * kLeastDiagonal ? std::max(bound, kappa + relaxation * jacobi) : bound;
    const float move = kappa - last[kSeenKappa];
    iterate[i] = {proposed, last[kAccepted], kappa, violation};
    return Progress{std::abs(std::max((bound - kappa) * diagonal, violation)),
                    (kappa - proposed) * diagonal * (proposed - last[kAccepted]), move * diagonal * move,
                    move * (last[kSeenViolation] - violation), violation};
  };
  const Progress own =
      first ? parallel_sum(particles.size(), Progress(),
                           [&](std::size_t i) { return progress(i, iterate[i][kFirstRate]); })
            : sum_over_rows(
                  particles, acceleration, Progress(),
                  [&](std::size_t i) { return density_rate(i, particles, lists, acceleration); },
                  [&](std::size_t i, float rate) {
                    return progress(i, rate + bodies.push_rate(i, particles));
                  });
  return sum_of_ranks(particles, own);
}

PressureSolve PressureSolver::solve(FluidParticles& particles, const NeighbourLists& lists, float time_step,
                                    double tolerance, int min_iterations, std::span<const float> least,
                                    const Coupling& bodies) {
  const std::size_t n = particles.size(), total = total_size(particles);
  if (total == 0) return {};  // all of it has flowed out
  const float square_step = time_step * time_step;
  auto& iterate_of = iterates(particles);
  // A rank without particles has no bounds of their own.
  const bool never_pulls = max_of_ranks(particles, least.empty() ? 0 : 1) == 0;
  const float scale = never_pulls ? fit_scale(particles, square_step, bodies) : 1;
  parallel_for(n, [&](std::size_t i) {
    const float kappa = particles.position[i][3];
    iterate_of[i] = {scale * iterate_of[i][kFirstRate], kappa, kappa, 0};
  });
  float momentum = 1, curvature = kFirstCurvature;
  for (int iterations = 0;; ++iterations) {
    const Progress progress =
        iterate(particles, lists, square_step, 1 / curvature, least, bodies, iterations == 0);
    const double mean_error = progress.error / static_cast<double>(total);
    const bool converged = mean_error <= tolerance && progress.max_error <= kMaxCompression;
    if ((converged && iterations >= min_iterations) || iterations == max_iterations_) {
      if (never_pulls) fit_scale(particles, square_step, bodies);
      return {iterations, mean_error, progress.max_error};
    }
    const bool too_long = progress.curved > curvature * progress.moved;
    if (too_long) curvature = 1.1f * static_cast<float>(progress.curved / progress.moved);
    if (too_long || progress.overshoot > 0) momentum = 1;
    const float next_momentum = 0.5f * (1 + std::sqrt(1 + 4 * momentum * momentum));
    const float extrapolation = (momentum - 1) / next_momentum;
    momentum = next_momentum;
    parallel_for(n, [&](std::size_t i) {
      Vec4f& it = iterate_of[i];
      particles.position[i][3] =
          std::max(bound_of(least, i), it[kProposed] + extrapolation * (it[kProposed] - it[kAccepted]));
      it[kAccepted] = it[kProposed];
    });
    accelerate_by_pressure(particles, lists, bodies);
  }
}

}  // namespace kappaflow
