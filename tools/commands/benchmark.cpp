#include "tools/commands/benchmark.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <utility>

#include "core/stopwatch.h"
#include "scenes/prepared_scene.h"
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

/// The scene with about as many particles.
PreparedScene resized(const PreparedScene& prepared, std::size_t particles) {
  const double now = static_cast<double>(prepared.start.position.size());
  Scene scene = prepared.scene;
  scene.fluid.spacing *= std::cbrt(now / static_cast<double>(particles));
  return prepare(std::move(scene));
}

Measurement measure(const PreparedScene& prepared, int threads, const BenchmarkOptions& options) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const Scene& scene = prepared.scene;
  const FluidParticlesAtStart& start = prepared.start;
  FluidSolver solver(scene.fluid, start.position, start.velocity, prepared.walls, start.fluid, start.source,
                     start.temperature);
  Measurement result;
  result.particles = start.position.size();
  result.threads = threads;
  for (int k = 0; k < options.warm_up + options.steps; ++k) {
    draw_status_line(fmt::format("{} particles, {} thread{}: step {} of {}", result.particles, threads,
                                 threads == 1 ? "" : "s", k + 1, options.warm_up + options.steps));
    const FluidStep step = solver.step(scene.duration);
    if (k >= options.warm_up) result.add(step, 1.0 / options.steps);
  }
  draw_status_line("");
  result.memory = solver.memory();
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
     [](const Measurement& m) { return per(static_cast<double>(m.memory.fluid), m.particles); }, 0},
    {"bytes_per_wall_particle",
     [](const Measurement& m) { return per(static_cast<double>(m.memory.walls), m.memory.wall_particles); },
     0},
};

std::string text(const Column& column, const Measurement& m) {
  return fmt::format("{:.{}f}", column.value(m), column.digits);
}

/// One line a column, one column a measurement: it fits a terminal.
std::string table(const std::vector<Measurement>& measurements) {
  std::string result;
  for (const Column& column : kColumns) {
    result += fmt::format("{:<30}", column.name);
    for (const Measurement& m : measurements) result += fmt::format("{:>12}", text(column, m));
    result += '\n';
  }
  return result;
}

std::string csv(const std::vector<Measurement>& measurements) {
  std::string result;
  for (const Column& column : kColumns) result += fmt::format("{}{}", result.empty() ? "" : ",", column.name);
  result += '\n';
  for (const Measurement& m : measurements) {
    std::string row;
    for (const Column& column : kColumns) row += fmt::format("{}{}", row.empty() ? "" : ",", text(column, m));
    result += row + '\n';
  }
  return result;
}

}  // namespace

std::string benchmark(const BenchmarkOptions& options) {
  const PreparedScene prepared = prepare(load_scene(options.scene));
  std::vector<Measurement> measurements;
  const auto run = [&](const PreparedScene& sized) {
    for (const int threads : options.threads) measurements.push_back(measure(sized, threads, options));
  };
  if (options.particles.empty()) run(prepared);
  for (const std::size_t particles : options.particles) run(resized(prepared, particles));
  if (!options.csv.empty()) write_file(options.csv, csv(measurements));
  return table(measurements);
}

}  // namespace kappaflow
