#include "tools/commands/benchmark.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <utility>

#include "core/stopwatch.h"
#include "scenes/prepared_scene.h"
#include "solver/broadcast_state.h"
#include "solver/fluid_solver.h"
#include "tools/io/files.h"
#include "tools/runs/progress.h"

namespace kappaflow {
namespace {

/// Means over the measured steps of one run.
struct Measurement {
  std::size_t particles = 0;
  int threads = 0;
  SolverMemory memory;
  SolverSeconds seconds;
  double time_step = 0;
  double density_iterations = 0, divergence_iterations = 0, viscosity_iterations = 0;
  std::vector<RankShare> shares;  // of the ranks that share the liquid; what they sent: in a measured step

  void add(const FluidStep& step, double share) {
    time_step += share * step.time_step;
    density_iterations += share * step.density_iterations;
    divergence_iterations += share * step.divergence_iterations;
    viscosity_iterations += share * step.viscosity_iterations;
    seconds.forces += share * step.seconds.forces;
    seconds.neighbours += share * step.seconds.neighbours;
    seconds.walls += share * step.seconds.walls;
    seconds.viscosity += share * step.seconds.viscosity;
    seconds.density += share * step.seconds.density;
    seconds.divergence += share * step.seconds.divergence;
    seconds.step += share * step.seconds.step;
  }
};

/// The particles come from the first of several ranks.
PreparedScene prepared_on(const Ranks* ranks, Scene scene) {
  return ranks != nullptr && ranks->rank() > 0 ? prepare_without_particles(std::move(scene))
                                               : prepare(std::move(scene));
}

/// A scene of so many particles with about as many as are wanted.
Scene resized(Scene scene, std::size_t particles, std::size_t wanted) {
  scene.fluid.spacing *= std::cbrt(static_cast<double>(particles) / static_cast<double>(wanted));
  return scene;
}

FluidSolver solver_of(const PreparedScene& prepared, Ranks* ranks) {
  const FluidParticlesAtStart& start = prepared.start;
  return {prepared.scene.fluid,
          start.position,
          start.velocity,
          prepared.walls,
          start.fluid,
          start.source,
          start.temperature,
          {},
          ranks};
}

/// A rank's share in the mean of so many steps.
void take_mean(RankShare& share, const RankShare& before, int steps) {
  RankTraffic& sent = share.traffic;
  sent.messages = (sent.messages - before.traffic.messages) / static_cast<std::size_t>(steps);
  sent.bytes = (sent.bytes - before.traffic.bytes) / static_cast<std::size_t>(steps);
  sent.seconds = (sent.seconds - before.traffic.seconds) / steps;
  share.own_seconds = (share.own_seconds - before.own_seconds) / steps;
}

Measurement measure(const PreparedScene& prepared, int threads, const BenchmarkOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  FluidSolver solver = solver_of(prepared, options.ranks);
  Measurement result;
  result.particles = solver.size();
  result.threads = threads;
  std::vector<RankShare> before;
  for (int k = 0; k < options.warm_up + options.steps; ++k) {
    draw_status_line(fmt::format("{} particles, {} thread{}: step {} of {}", result.particles, threads,
                                 threads == 1 ? "" : "s", k + 1, options.warm_up + options.steps));
    if (k == options.warm_up) before = solver.shares();
    const FluidStep step = solver.step(prepared.scene.duration);
    if (k >= options.warm_up) result.add(step, 1.0 / options.steps);
  }
  draw_status_line("");
  result.memory = solver.memory();
  result.shares = solver.shares();
  for (std::size_t r = 0; r < before.size(); ++r) take_mean(result.shares[r], before[r], options.steps);
  return result;
}

/// One column of the table: a heading and how a measurement reads in it.
struct Column {
  const char* name;
  double (*value)(const Measurement&);
  int digits;
};

double per(double amount, std::size_t count) {
  return count > 0 ? amount / static_cast<double>(count) : 0;
}

template <class Value>
double largest(const Measurement& m, const Value& value) {
  double result = 0;
  for (const RankShare& share : m.shares) result = std::max(result, static_cast<double>(value(share)));
  return result;
}

constexpr Column kColumns[] = {
    {"particles", [](const Measurement& m) { return static_cast<double>(m.particles); }, 0},
    {"wall_particles", [](const Measurement& m) { return static_cast<double>(m.memory.wall_particles); }, 0},
    {"threads", [](const Measurement& m) { return static_cast<double>(m.threads); }, 0},
    {"step_ms", [](const Measurement& m) { return 1e3 * m.seconds.step; }, 1},
    {"forces_ms", [](const Measurement& m) { return 1e3 * m.seconds.forces; }, 1},
    {"neighbours_ms", [](const Measurement& m) { return 1e3 * m.seconds.neighbours; }, 1},
    {"walls_ms", [](const Measurement& m) { return 1e3 * m.seconds.walls; }, 1},
    {"viscosity_ms", [](const Measurement& m) { return 1e3 * m.seconds.viscosity; }, 1},
    {"density_ms", [](const Measurement& m) { return 1e3 * m.seconds.density; }, 1},
    {"divergence_ms", [](const Measurement& m) { return 1e3 * m.seconds.divergence; }, 1},
    {"viscosity_iterations", [](const Measurement& m) { return m.viscosity_iterations; }, 1},
    {"density_iterations", [](const Measurement& m) { return m.density_iterations; }, 1},
    {"divergence_iterations", [](const Measurement& m) { return m.divergence_iterations; }, 1},
    {"time_step_ms", [](const Measurement& m) { return 1e3 * m.time_step; }, 3},
    {"particle_steps_per_s",
     [](const Measurement& m) { return static_cast<double>(m.particles) / m.seconds.step; }, 0},
    {"seconds_per_simulated_second", [](const Measurement& m) { return m.seconds.step / m.time_step; }, 1},
    {"bytes_per_particle",
     [](const Measurement& m) {
       double all = m.shares.empty() ? static_cast<double>(m.memory.fluid) : 0;
       for (const RankShare& share : m.shares) all += static_cast<double>(share.memory);
       return per(all, m.particles);
     },
     0},
    {"bytes_per_wall_particle",
     [](const Measurement& m) { return per(static_cast<double>(m.memory.walls), m.memory.wall_particles); },
     0},
};

// Of several ranks, the most that one of them has.
constexpr Column kColumnsOfRanks[] = {
    {"ranks", [](const Measurement& m) { return static_cast<double>(m.shares.size()); }, 0},
    {"particles_of_rank",
     [](const Measurement& m) { return largest(m, [](const RankShare& s) { return s.particles; }); }, 0},
    {"ghosts_of_rank",
     [](const Measurement& m) { return largest(m, [](const RankShare& s) { return s.ghosts; }); }, 0},
    {"bytes_of_rank",
     [](const Measurement& m) { return largest(m, [](const RankShare& s) { return s.memory; }); }, 0},
    {"messages_per_step",
     [](const Measurement& m) { return largest(m, [](const RankShare& s) { return s.traffic.messages; }); },
     0},
    {"megabytes_per_step",
     [](const Measurement& m) {
       return 1e-6 * largest(m, [](const RankShare& s) { return s.traffic.bytes; });
     },
     2},
    {"exchange_ms",
     [](const Measurement& m) {
       return 1e3 * largest(m, [](const RankShare& s) { return s.traffic.seconds; });
     },
     1},
};

std::string text(const Column& column, const Measurement& m) {
  return fmt::format("{:.{}f}", column.value(m), column.digits);
}

std::vector<Column> columns_of(const std::vector<Measurement>& measurements) {
  std::vector<Column> columns(std::begin(kColumns), std::end(kColumns));
  if (!measurements.front().shares.empty())
    columns.insert(columns.end(), std::begin(kColumnsOfRanks), std::end(kColumnsOfRanks));
  return columns;
}

/// One line a column, one column a measurement: it fits a terminal.
std::string table(const std::vector<Measurement>& measurements) {
  std::string result;
  for (const Column& column : columns_of(measurements)) {
    result += fmt::format("{:<30}", column.name);
    for (const Measurement& m : measurements) result += fmt::format("{:>12}", text(column, m));
    result += '\n';
  }
  return result;
}

std::string csv(const std::vector<Measurement>& measurements) {
  const std::vector<Column> columns = columns_of(measurements);
  std::string result;
  for (const Column& column : columns) result += fmt::format("{}{}", result.empty() ? "" : ",", column.name);
  result += '\n';
  for (const Measurement& m : measurements) {
    std::string row;
    for (const Column& column : columns) row += fmt::format("{}{}", row.empty() ? "" : ",", text(column, m));
    result += row + '\n';
  }
  return result;
}

/// What --shares would balance the ranks; nothing where one of them has no liquid to be measured by.
std::string shares_line(const Measurement& m) {
  std::vector<double> speeds;
  for (const RankShare& rank : m.shares)
    speeds.push_back(static_cast<double>(rank.particles) / rank.own_seconds);
  if (speeds.empty() || !std::ranges::all_of(speeds, [](double speed) { return speed > 0; })) return "";
  std::string words;
  for (const double share : balanced_shares(speeds))
    words += fmt::format("{}{:.2g}", words.empty() ? "" : ",", share);
  return fmt::format("shares {}\n", words);
}

/// Calls work(scene, threads) for every size and number of threads. particles: of the scene itself.
template <class Work>
void for_cases(const BenchmarkOptions& options, const PreparedScene& prepared, std::size_t particles,
               const Work& work) {
  const auto at_size = [&](const PreparedScene& sized) {
    for (const int threads : options.threads) work(sized, threads);
  };
  if (options.particles.empty()) at_size(prepared);
  for (const std::size_t wanted : options.particles)
    at_size(prepared_on(options.ranks, resized(prepared.scene, particles, wanted)));
}

}  // namespace

std::string benchmark(const BenchmarkOptions& options) {
  const PreparedScene prepared = prepare(load_scene(options.scene));
  std::size_t particles = prepared.start.position.size();
  if (options.ranks != nullptr) {
    options.ranks->announce({RankTask::resume});
    broadcast_state(*options.ranks, particles);
    options.ranks->finish();
  }
  std::vector<Measurement> measurements;
  for_cases(options, prepared, particles, [&](const PreparedScene& sized, int threads) {
    measurements.push_back(measure(sized, threads, options));
  });
  if (!options.csv.empty()) write_file(options.csv, csv(measurements));
  std::string text = table(measurements);
  for (const Measurement& m : measurements) text += shares_line(m);
  return text;
}

std::vector<double> balanced_shares(const std::vector<double>& speeds) {
  constexpr double kScatter = 0.1;  // of measured speeds
  std::vector<std::size_t> order(speeds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater(), [&](std::size_t rank) { return speeds[rank]; });
  std::vector<double> shares(speeds.size());
  for (auto begin = order.begin(); begin != order.end();) {
    const auto end = std::find_if(
        begin, order.end(), [&](std::size_t rank) { return speeds[rank] < (1 - kScatter) * speeds[*begin]; });
    double sum = 0;
    for (auto rank = begin; rank != end; ++rank) sum += speeds[*rank];
    for (auto rank = begin; rank != end; ++rank) shares[*rank] = sum / static_cast<double>(end - begin);
    begin = end;
  }
  const double most = shares[order.front()];
  for (double& share : shares) share /= most;
  return shares;
}

void follow_benchmark(const BenchmarkOptions& options) {
  const PreparedScene prepared = prepare_without_particles(load_scene(options.scene));
  if (options.ranks->next_order().task == RankTask::end) return;
  std::size_t particles = 0;
  broadcast_state(*options.ranks, particles);
  std::optional<RankTask> task;  // what the first rank does next, once it has said so
  for_cases(options, prepared, particles, [&](const PreparedScene& sized, int threads) {
    if (!task) task = options.ranks->next_order().task;
    if (task == RankTask::end) return;
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    task = solver_of(sized, options.ranks).follow().task;
  });
}

}  // namespace kappaflow
