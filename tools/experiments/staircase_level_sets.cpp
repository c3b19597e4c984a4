#include "tools/experiments/staircase_level_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/nearest_points.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "core/solid_distance.h"
#include "core/stopwatch.h"
#include "scenes/prepared_scene.h"
#include "scenes/scene.h"
#include "surface/measure/surface_metrics.h"
#include "surface/mesh/mesh_measures.h"
#include "tools/experiments/grid_level_set.h"
#include "tools/runs/simulation.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

constexpr double kMotionPerStep = 0.5;  // [sigma] of the fast particles, as tracked surfaces move by default

/// A surface at the times that it is compared at.
struct Line {
  std::string method, resolution;
  std::vector<std::string> volume, distance;  ///< texts, one a time
  std::vector<double> seconds;                ///< of each frame
};

/// A level set, and what becomes of it.
struct MovedSet {
  GridLevelSet set;
  Line line;
};

/// Of the particles around, or where none is in reach of the nearest one.
GridLevelSet::Velocities velocities_of(const Field& field, const Particles& particles) {
  return [&](const std::vector<Vec3>& place, std::vector<Vec3>& velocity) {
    std::vector<char> is_known(place.size());
    parallel_for(place.size(), [&](std::size_t i) {
      const std::optional<Vec3> known = field.material_velocity(place[i]);
      is_known[i] = known.has_value();
      if (known) velocity[i] = *known;
    });
    std::vector<std::size_t> unknown;
    std::vector<Vec3> beyond;
    for (std::size_t i = 0; i < place.size(); ++i)
      if (!is_known[i]) unknown.push_back(i), beyond.push_back(place[i]);
    const std::vector<std::uint32_t> nearest = nearest_points(particles.position, beyond);
    for (std::size_t k = 0; k < unknown.size(); ++k) velocity[unknown[k]] = particles.velocity[nearest[k]];
  };
}

/// Steps in which the fast particles move by kMotionPerStep at most.
void move_sets(const Particles& before, const Particles& now, const ParticleFieldOptions& options,
               std::vector<MovedSet>& sets) {
  ParticleFieldOptions round = options;  // whose material velocities are the same
  round.kernels = Kernels::round;
  ParticleMotion motion(before, now, round);
  const double speed = std::max(fast_speed(before), fast_speed(now)), span = now.time - before.time;
  const int steps = std::max(1, static_cast<int>(std::ceil(speed * span / (kMotionPerStep * options.sigma))));
  for (int s = 0; s < steps; ++s) {
    const auto field = motion.at(before.time + (s + 0.5) / steps * span);
    const auto velocities = velocities_of(*field, now);
    for (MovedSet& moved : sets)
      moved.line.seconds.back() +=
          seconds_of([&] { moved.set.advect(velocities, field->fastest_speed(), span / steps); });
  }
}

/// From the centres of the triangles of one to the other: their mean, and the largest [m].
std::pair<double, double> distance_to(const TriangleSurface& to, const TriangleSurface& from) {
  const SolidDistance solid(to);
  std::vector<double> distance(from.triangles.size());
  parallel_for(distance.size(), [&](std::size_t t) {
    const auto& [a, b, c] = from.triangles[t];
    distance[t] =
        std::abs(solid.nearest((from.vertices[a] + from.vertices[b] + from.vertices[c]) / 3).distance);
  });
  return {parallel_sum(distance.size(), 0.0, [&](std::size_t t) { return distance[t]; }) /
              static_cast<double>(distance.size()),
          parallel_max(distance.size(), 0.0, [&](std::size_t t) { return distance[t]; })};
}

/// Both ways, of which the larger counts.
void compare(const TriangleSurface& surface, const TriangleSurface& isosurface, double sigma, Line& line) {
  const double volume = area_and_volume(isosurface.vertices, isosurface.triangles).volume;
  line.volume.push_back(fmt::format(
      "{:+.2f} %", 100 * (area_and_volume(surface.vertices, surface.triangles).volume / volume - 1)));
  if (surface.triangles.empty()) {
    line.distance.emplace_back("nothing left");
    return;
  }
  const auto [mean, max] = distance_to(isosurface, surface);
  const auto [mean_back, max_back] = distance_to(surface, isosurface);
  line.distance.push_back(
      fmt::format("{:.2g}, {:.2g}", std::max(mean, mean_back) / sigma, std::max(max, max_back) / sigma));
}

std::vector<MovedSet> sets_of(const TriangleMesh& first, const std::vector<double>& spacings, double sigma) {
  std::vector<MovedSet> sets;
  for (const double spacing : spacings)
    for (const auto& [name, scheme] : kLevelSetSchemes)
      sets.push_back({GridLevelSet({first.position, first.triangles}, spacing * sigma, scheme),
                      {std::string(name), fmt::format("{} sigma", spacing), {}, {}, {}}});
  return sets;
}

std::vector<std::string> cells_of(const Line& line) {
  std::vector<std::string> cells{line.method, line.resolution};
  cells.insert(cells.end(), line.volume.begin(), line.volume.end());
  cells.insert(cells.end(), line.distance.begin(), line.distance.end());
  std::vector<double> seconds = line.seconds;
  cells.push_back(fmt::format("{:.2g}", upper_median(seconds)));
  return cells;
}

Table table_of(const std::vector<Line>& lines, const std::vector<double>& times) {
  Table table{
      "The staircase. *Volume* against the isosurface of the particles at that time; *distance*, mean and "
      "largest, "
      "between the surface and that isosurface in sigma, the larger of both directions; *time a frame*, "
      "median, of the "
      "surface alone. Level sets move in the affine moving-least-squares velocity of the particles, sampled "
      "on their "
      "grid in the middle of each step, and know nothing else; tracked surfaces are put back onto f = 0 in "
      "each.",
      {"method", "grid or edge"},
      {}};
  for (const double time : times) table.header.push_back(fmt::format("volume at {} s", time));
  for (const double time : times) table.header.push_back(fmt::format("distance at {} s", time));
  table.header.emplace_back("time a frame [s]");
  for (const Line& line : lines) table.rows.push_back(cells_of(line));
  return table;
}

}  // namespace

Table staircase_table(const ExperimentContext& context, const StaircaseOptions& options) {
  Scene scene = load_scene(options.scene);
  scene.surface.methods = options.methods;
  Simulation simulation(prepare(scene));
  const TrackedSurfaces& surfaces = simulation.surfaces();
  const double sigma = surfaces.field_options().sigma;
  std::vector<MovedSet> sets =
      sets_of(fresh_isosurface(simulation.field(), sigma).mesh, options.spacings, sigma);
  std::vector<Line> lines;
  for (const std::string& method : options.methods)
    lines.push_back({method, fmt::format("edge {} sigma", scene.surface.edge_length), {}, {}, {}});
  Particles before = simulation.particles();
  for (int frame = 1; frame_time(scene, frame - 1) < options.times.back(); ++frame) {
    context.say(fmt::format("staircase, t = {:.2f} s", before.time));
    simulation.advance(frame_time(scene, frame), [](const FluidStep&) { return true; });
    const SimulationReport report = simulation.take_report();
    for (std::size_t m = 0; m < lines.size(); ++m)
      lines[m].seconds.push_back(phase_seconds(report.surfaces[m], 0, 0).surface());
    for (MovedSet& moved : sets) moved.line.seconds.push_back(0);
    move_sets(before, simulation.particles(), surfaces.field_options(), sets);
    before = simulation.particles();
    if (std::ranges::none_of(options.times, [&](double t) { return std::abs(t - before.time) < 1e-9; }))
      continue;
    const TriangleMesh fresh = fresh_isosurface(simulation.field(), sigma).mesh;
    const TriangleSurface isosurface{fresh.position, fresh.triangles};
    for (std::size_t m = 0; m < lines.size(); ++m)
      compare({surfaces.mesh(m).position, surfaces.mesh(m).triangles}, isosurface, sigma, lines[m]);
    for (MovedSet& moved : sets) compare(moved.set.surface(), isosurface, sigma, moved.line);
  }
  for (const MovedSet& moved : sets) lines.push_back(moved.line);
  return table_of(lines, options.times);
}

}  // namespace kappaflow
