#include "solver/heat.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

constexpr double kStefanBoltzmann = 5.670374419e-8;  // [W/(m2 K4)]
// Sum over a cubic lattice of the kernel's support of V |F| x^2, which for a continuum is 1.
constexpr double kLatticeMoment = 1.0200417;
// What each open face lacks of the density: a plane of a lattice 0.15, liquid that has flowed 0.17 to 0.19.
constexpr float kOpenFace = 1.0f / 6;
// Densities that lack less are those of gaps within the liquid, up to the first, and from the second on those
// of surfaces.
constexpr float kGap = 0.04f, kSurface = 0.12f;
// Error of a step's change in temperature over the largest change at which the solve ends.
constexpr double kTolerance = 1e-4;
constexpr int kMostIterations = 1000;

}  // namespace

float free_area(float density, float spacing) {
  const float lack = std::max(1 - density, 0.0f),
              t = std::clamp((lack - kGap) / (kSurface - kGap), 0.0f, 1.0f);
  return t * t * (3 - 2 * t) * lack / (kOpenFace * spacing);
}

HeatSolver::HeatSolver(const FluidOptions& options)
    : options_(options.heat),
      spacing_(static_cast<float>(options.spacing)),
      volume_(std::pow(options.spacing, 3)) {
  if (!options_) return;
  for (const Emitter& emitter : options.emitters)
    emitter_temperature_.push_back(emitter.temperature.value_or(options_->temperature));
  for (std::size_t fluid = 0; fluid < options_->fluids.size(); ++fluid) {
    capacity_.push_back(options.rest_density(fluid) * options_->fluids[fluid].specific_heat);
    conductivity_.push_back(options_->fluids[fluid].conductivity);
  }
  for (const double a : conductivity_)
    for (const double b : conductivity_)
      pair_conductivity_.push_back(a + b > 0 ? 2 * a * b / (a + b) / kLatticeMoment : 0);
}

void HeatSolver::add_new(FluidParticles& particles) const {
  if (!needed()) return;
  for (std::size_t i = particles.temperature.size(); i < particles.size(); ++i)
    particles.temperature.push_back(emitter_temperature_[particles.led_by[i] - 1u]);
}

/// Calls visit(j, w): the pair exchanges the heat w (T_j - T_i) [W/m3].
template <class Visit>
inline void HeatSolver::for_pairs(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                                  const Visit& visit) const {
  const double* const with = pair_conductivity_.data() + particles.fluid[i] * capacity_.size();
  for (const PairBlock& block : lists.of(i)) {
    const Wide factor = lists.factor(block);
    for (std::size_t lane = 0; lane < kWide; ++lane) {
      const std::size_t j = block.base + block.offset[lane];
      visit(j, -2 * with[particles.fluid[j]] * static_cast<double>(factor[static_cast<int>(lane)]));
    }
  }
}

/// Of what conducts between the particle and a wall of given temperature that it touches [W/(m3 K)].
double HeatSolver::contact_conductance(std::size_t i, std::size_t contact, const FluidParticles& particles,
                                       const WallSums& walls) const {
  return conductivity_[particles.fluid[i]] *
         static_cast<double>(walls.friction[contact][3] * walls.heat[contact].held);
}

/// The same of all walls.
double HeatSolver::wall_conductance(std::size_t i, const FluidParticles& particles,
                                    const WallSums& walls) const {
  if (walls.heat.empty()) return 0;
  double sum = 0;
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k)
    sum += contact_conductance(i, k, particles, walls);
  return sum;
}

/// Between the particle and the air, linear about its temperature [W/(m3 K)].
double HeatSolver::air_conductance(std::size_t i, const FluidParticles& particles) const {
  if (!options_->cools() || particles.led_by[i] != 0) return 0;
  const double t = particles.temperature[i], air = options_->ambient_temperature;
  const double radiation = options_->emissivity * kStefanBoltzmann * (t * t + air * air) * (t + air);
  return static_cast<double>(free_area(particles.density[i], spacing_)) * (options_->convection + radiation);
}

/// What the walls give the particle where its temperature is t [W/m3]. g = 1 / (spacing d) is the area over
/// the volume, 1 / spacing, where liquid rests.
double HeatSolver::from_walls(std::size_t i, const FluidParticles& particles, const WallSums& walls,
                              double t) const {
  if (walls.heat.empty()) return 0;
  double sum = 0;
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k) {
    const WallHeatSum& heat = walls.heat[k];
    const double area = kContactDistance * static_cast<double>(spacing_ * walls.friction[k][3]);
    sum += area * static_cast<double>(heat.flux) +
           contact_conductance(i, k, particles, walls) * (static_cast<double>(heat.temperature) - t);
  }
  return sum;
}

void HeatSolver::set_up(const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                        double time_step) {
  for (auto* array : {&diagonal_, &right_, &change_, &residual_, &direction_, &image_})
    array->resize(particles.size());
  const std::vector<double>& t = particles.temperature;
  parallel_for(particles.size(), [&](std::size_t i) {
    double sum = 0, flow = from_walls(i, particles, walls, t[i]);
    for_pairs(i, particles, lists, [&](std::size_t j, double weight) {
      sum += weight;
      flow += weight * (t[j] - t[i]);
    });
    const double wall = wall_conductance(i, particles, walls), air = air_conductance(i, particles);
    flow += air * (options_->ambient_temperature - t[i]);
    diagonal_[i] = capacity_[particles.fluid[i]] + time_step * (sum + wall + air);
    right_[i] = time_step * flow;
  });
}

HeatSolve HeatSolver::iterate(const FluidParticles& particles, const NeighbourLists& lists,
                              double time_step) {
  const std::size_t n = particles.size();
  const auto most = [&](const auto& value) { return max_of_ranks(particles, parallel_max(n, 0.0, value)); };
  const auto sum = [&](const auto& value) { return sum_of_ranks(particles, parallel_sum(n, 0.0, value)); };
  const auto largest = [&](const std::vector<double>& heat) {
    return most([&](std::size_t i) { return std::abs(heat[i]) / capacity_[particles.fluid[i]]; });
  };
  parallel_for(n, [&](std::size_t i) {
    change_[i] = direction_[i] = 0;
    residual_[i] = right_[i];
  });
  const double first = largest(right_);
  HeatSolve result;
  if (!(first > 0)) return result;
  double energy = 0;
  do {
    const double last = energy;
    energy = sum([&](std::size_t i) { return residual_[i] * residual_[i] / diagonal_[i]; });
    const double factor = last > 0 ? energy / last : 0;
    parallel_for(
        n, [&](std::size_t i) { direction_[i] = residual_[i] / diagonal_[i] + factor * direction_[i]; });
    fill_ghosts(particles, direction_);
    const double curvature = sum([&](std::size_t i) {
      double of_pairs = 0;
      for_pairs(i, particles, lists,
                [&](std::size_t j, double weight) { of_pairs += weight * direction_[j]; });
      image_[i] = diagonal_[i] * direction_[i] - time_step * of_pairs;
      return direction_[i] * image_[i];
    });
    const double length = energy / curvature;
    parallel_for(n, [&](std::size_t i) {
      change_[i] += length * direction_[i];
      residual_[i] -= length * image_[i];
    });
    const double changed = most([&](std::size_t i) { return std::abs(change_[i]); });
    result.error = largest(residual_) / (kTolerance * std::min(first, changed));
  } while (++result.iterations < kMostIterations && result.error > 1);
  return result;
}

void HeatSolver::exchange(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                          double time_step, HeatSolve& result) {
  const std::size_t n = particles.size();
  std::vector<double>&after = direction_, &given = residual_, &lost = image_;
  parallel_for(n, [&](std::size_t i) { after[i] = particles.temperature[i] + change_[i]; });
  fill_ghosts(particles, after);
  parallel_for(n, [&](std::size_t i) {
    double flow = 0;
    for_pairs(i, particles, lists,
              [&](std::size_t j, double weight) { flow += weight * (after[j] - after[i]); });
    given[i] = from_walls(i, particles, walls, after[i]);
    lost[i] = air_conductance(i, particles) * (after[i] - options_->ambient_temperature);
    change_[i] = time_step * (flow + given[i] - lost[i]) / capacity_[particles.fluid[i]];
  });
  parallel_for(n, [&](std::size_t i) { particles.temperature[i] += change_[i]; });
  const int unsound = parallel_max(n, 0, [&](std::size_t i) {
    const double t = particles.temperature[i];
    return t > 0 && std::isfinite(t) ? 0 : 1;
  });
  result.sound = max_of_ranks(particles, unsound) == 0;
  const auto total = [&](const std::vector<double>& power) {
    const double own = parallel_sum(n, 0.0, [&](std::size_t i) { return power[i]; });
    return volume_ * time_step * sum_of_ranks(particles, own);
  };
  result.from_walls = total(given);
  result.from_air = -total(lost);
}

HeatSolve HeatSolver::solve(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                            float time_step) {
  if (!needed()) return {};
  const double dt = static_cast<double>(time_step);
  fill_ghosts(particles, particles.temperature);
  set_up(particles, lists, walls, dt);
  HeatSolve result = iterate(particles, lists, dt);
  exchange(particles, lists, walls, dt, result);
  return result;
}

}  // namespace kappaflow
