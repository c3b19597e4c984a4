// The phases of a time step on a slab of liquid that settles on a floor; items per second are particles (per
// iteration, where a phase iterates). Arguments: particles, threads.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>

#include "core/parallel.h"
#include "core/wide.h"
#include "solver/boundary_sampling.h"
#include "solver/fluid_solver.h"
#include "solver/pressure.h"
#include "solver/start.h"
#include "solver/viscosity.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.04;
constexpr float kTimeStep = 3e-3f;

TriangleSurface floor_under(double width) {
  TriangleSurface box;
  for (int i = 0; i < 8; ++i)
    box.vertices.emplace_back(i & 1 ? width + 0.2 : -0.2, i & 2 ? 0 : -0.2, i & 4 ? width + 0.2 : -0.2);
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return box;
}

struct Slab {
  explicit Slab(std::size_t particles) : wall(floor_under(kSpacing * side(particles))) {
    for (int j = 0; j < kLayers; ++j)
      for (int k = 0; k < side(particles); ++k)
        for (int i = 0; i < side(particles); ++i) {
          position.push_back(kSpacing * Vec3(i + 0.5, j + 0.5, k + 0.5));
          velocity.emplace_back(std::sin(3 * position.back().z()), 0, std::cos(2 * position.back().y()));
        }
    options.spacing = kSpacing;
  }

  static constexpr int kLayers = 10;
  static int side(std::size_t particles) {
    return static_cast<int>(std::lround(std::sqrt(static_cast<double>(particles) / kLayers)));
  }

  TriangleSurface wall;
  std::vector<Vec3> position, velocity;
  FluidOptions options;
};

/// The slab as it is before each phase.
struct Phases : Slab {
  explicit Phases(std::size_t n)
      : Slab(n),
        particles(particles_at_start(position, velocity)),
        search(static_cast<float>(kSpacing)),
        walls(bodies(), static_cast<float>(kSpacing)) {
    search.sort(particles);
    find();
  }

  std::vector<WallBody> bodies() const {
    return {{sample_walls(solid_walls(std::span(&wall, 1)), kSpacing), {}}};
  }
  void find() {
    search.find(particles, lists);
    walls.add_to(particles, wall_sums);
  }

  FluidParticles particles;
  NeighbourSearch search;
  Walls walls;
  NeighbourLists lists;
  WallSums wall_sums;
};

/// Runs phase() until the clock is satisfied; phase returns how often it went over the particles.
template <class Phase>
void measure(benchmark::State& state, const Phase& phase) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  std::int64_t sweeps = 0;
  for (auto _ : state) sweeps += phase();
  state.SetItemsProcessed(sweeps * state.range(0));
}

std::size_t count(const benchmark::State& state) {
  return static_cast<std::size_t>(state.range(0));
}

void sort_particles(benchmark::State& state) {
  Phases p(count(state));
  measure(state, [&] { return p.search.sort(p.particles), 1; });
}

void find_neighbours(benchmark::State& state) {
  Phases p(count(state));
  measure(state, [&] { return p.search.find(p.particles, p.lists), 1; });
}

void sum_walls(benchmark::State& state) {
  Phases p(count(state));
  measure(state, [&] {
    p.walls.add_to(p.particles, p.wall_sums);
    return 1;
  });
}

void viscosity_iteration(benchmark::State& state) {
  Phases p(count(state));
  ViscositySolver solver(p.options);
  const std::vector<Vec4f> velocity = p.particles.velocity, change = p.particles.viscous_velocity;
  measure(state, [&] {
    p.particles.velocity = velocity;
    p.particles.viscous_velocity = change;
    return solver.solve(p.particles, p.lists, p.wall_sums, kTimeStep).iterations;
  });
}

void pressure_iteration(benchmark::State& state) {
  Phases p(count(state));
  p.options.density_tolerance = 1e-7;
  p.options.max_pressure_iterations = 10;
  PressureSolver solver(p.options);
  const std::vector<Vec4f> velocity = p.particles.velocity;
  measure(state, [&] {
    p.particles.velocity = velocity;
    solver.apply_last(p.particles, p.lists, kTimeStep);
    return solver.correct_density(p.particles, p.lists, p.wall_sums, kTimeStep).iterations;
  });
}

void whole_step(benchmark::State& state) {
  const Slab slab(count(state));
  FluidSolver solver(slab.options, slab.position, slab.velocity, solid_walls(std::span(&slab.wall, 1)));
  for (int k = 0; k < 20; ++k) solver.step(10);
  measure(state, [&] { return solver.step(10), 1; });
}

// What the machine can do at best, to hold the phases against. Arguments: megabytes, threads; 0, threads.

constexpr std::size_t kTaskGrain = 1;

void read_memory(benchmark::State& state) {
  const std::vector<float> values(count(state) << 18, 1.0f);
  measure(state, [&] {
    double sum = parallel_sum<double>(
        values.size() / 4096, 0,
        [&](std::size_t chunk) {
          return static_cast<double>(Eigen::Map<const Eigen::ArrayXf>(&values[4096 * chunk], 4096).sum());
        },
        kTaskGrain);
    benchmark::DoNotOptimize(sum);
    return 1;
  });
  state.SetBytesProcessed(state.iterations() * (state.range(0) << 20));
}

void multiply_add(benchmark::State& state) {
  constexpr int kChains = 10, kRounds = 10000, kTasks = 64;  // as many chains as hide the latency
  measure(state, [&] {
    double sum = parallel_sum<double>(
        kTasks, 0,
        [&](std::size_t task) {
          std::array<Wide, kChains> x;
          x.fill(Wide::Constant(static_cast<float>(task)));
          for (int k = 0; k < kRounds; ++k)
            for (Wide& chain : x) chain = 0.999f * chain + 0.001f;
          for (const Wide& chain : x) x[0] += chain;
          return static_cast<double>(x[0].sum());
        },
        kTaskGrain);
    benchmark::DoNotOptimize(sum);
    return 1;
  });
  state.counters["Flop/s"] =
      benchmark::Counter(2.0 * 8 * kChains * kRounds * kTasks * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

void sizes_and_threads(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{10240, 100000, 1000000}, {1, 2}})->UseRealTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK(sort_particles)->Apply(sizes_and_threads);
BENCHMARK(find_neighbours)->Apply(sizes_and_threads);
BENCHMARK(sum_walls)->Apply(sizes_and_threads);
BENCHMARK(viscosity_iteration)->Apply(sizes_and_threads);
BENCHMARK(pressure_iteration)->Apply(sizes_and_threads);
BENCHMARK(whole_step)->Apply(sizes_and_threads);
BENCHMARK(read_memory)->ArgsProduct({{1, 1024}, {1, 2}})->UseRealTime();
BENCHMARK(multiply_add)->ArgsProduct({{0}, {1, 2}})->UseRealTime();

}  // namespace
}  // namespace kappaflow

BENCHMARK_MAIN();
