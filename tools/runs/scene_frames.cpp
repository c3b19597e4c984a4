#include "tools/runs/scene_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/errors.h"
#include "core/state_bytes.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/liquid_metrics.h"
#include "tools/runs/surface_temperature.h"

namespace kappaflow {

SceneFrames::SceneFrames(const PreparedScene& prepared, std::unique_ptr<Liquid> liquid)
    : scene_(prepared.scene),
      simulation_(prepared, std::move(liquid)),
      wall_distance_(simulation_.solids_at_start()) {
  if (scene_.fluid.heat) add_temperatures(surfaces());
}

void SceneFrames::announce(RankTask task, double value) {
  if (surface_ranks() != nullptr) surface_ranks()->announce({task, value});
}

bool SceneFrames::advance(int frame, const Watch& watch) {
  announce(RankTask::go_to, frame);
  return go_to(frame, watch);
}

FieldMeasures SceneFrames::measure_field(bool is_judged, std::span<const Vec3> particles) {
  announce(RankTask::measure_field, is_judged ? 1 : 0);
  return together(surface_ranks(), [&] { return FrameSource::measure_field(is_judged, particles); });
}

SurfaceMeasures SceneFrames::measure_surface(std::size_t surface, const FieldMeasures& field) {
  announce(RankTask::measure_surface, static_cast<double>(surface));
  return together(surface_ranks(), [&] { return FrameSource::measure_surface(surface, field); });
}

void SceneFrames::read_state(StateReader& archive) {
  archive(simulation_);
  if (surface_ranks() == nullptr) return;
  announce(RankTask::restore_surfaces, 0);
  std::string state = bytes_written([&](StateWriter& told) {
    told(time(), steps());
    simulation_.serialize_surfaces(told);
  });
  surface_ranks()->broadcast_values(state);
  surface_ranks()->finish();
}

/// From what the first rank's read_state() tells.
void SceneFrames::restore_followed() {
  std::string state;
  surface_ranks()->broadcast_values(state);
  read_bytes(std::move(state), [&](StateReader& told) {
    simulation_.liquid().read_state(told);
    simulation_.serialize_surfaces(told);
  });
}

void SceneFrames::follow() {
  Ranks& ranks = *surface_ranks();
  FieldMeasures measures;
  for (RankOrder order = ranks.next_order(); order.task != RankTask::end; order = ranks.next_order())
    switch (order.task) {
      case RankTask::go_to:
        measures = {};  // of the frame before
        go_to(static_cast<int>(order.value), [](const std::string&) { return true; });
        break;
      case RankTask::measure_field:
        measures = together(&ranks, [&] {
          return FrameSource::measure_field(order.value != 0, surfaces().particles().position);
        });
        break;
      case RankTask::measure_surface:
        together(&ranks, [&] {
          return FrameSource::measure_surface(static_cast<std::size_t>(order.value), measures);
        });
        break;
      case RankTask::restore_surfaces:
        restore_followed();
        break;
      default:
        throw std::logic_error("ranks that follow surfaces are out of step");
    }
}

bool SceneFrames::go_to(int frame, const Watch& watch) {
  return together(surface_ranks(), [&] {
    return simulation_.advance(time_of(frame), [&](const FluidStep& step) {
      return watch(fmt::format("pressure {}, viscosity {}",
                               step.density_iterations + step.divergence_iterations,
                               step.viscosity_iterations));
    });
  });
}

std::vector<TriangleSurface> SceneFrames::walls_at_start() const {
  return surfaces_of(simulation_.solids_at_start());
}

FrameReport SceneFrames::take_report(int frame) {
  FrameReport report;
  FrameMetrics& metrics = report.metrics;
  metrics.frame = frame;
  metrics.time = time_of(frame);
  if (walls_move()) {
    const std::vector<SolidWall> solids = simulation_.solids_now();
    wall_distance_ = WallDistance(solids);
    report.walls = surfaces_of(solids);
  }
  LiquidRecord liquid = simulation_.liquid().record();
  report.bodies = std::move(liquid.bodies);
  report.particles = std::move(liquid.particles);
  report.pieces = liquid.pieces;
  report.ranks = liquid_ranks();
  if (liquid.temperature) set_temperatures(report.particles, *liquid.temperature, surfaces(), metrics);
  const SimulationReport since = simulation_.take_report();
  metrics.particles = liquid.count;
  metrics.particles_taken = std::accumulate(liquid.taken.begin(), liquid.taken.end(), std::size_t{0});
  metrics.taken_by_region = taken_text(liquid.taken);
  metrics.penetration_max =
      penetration_max(report.particles.particles.position, wall_distance_, scene_.fluid.spacing);
  metrics.density_error_mean = std::max(liquid.compression.mean, since.density_error_mean);
  metrics.density_error_max = std::max(liquid.compression.max, since.density_error_max);
  metrics.viscosity_error = since.viscosity_error;
  report.steps = since.surfaces;
  report.liquid_seconds = since.solver_seconds;
  report.tracer_seconds = since.tracer_seconds;
  return report;
}

std::string SceneFrames::kept_particles(const std::filesystem::path& file) const {
  if (!simulation_.liquid().can_be_asked()) return "its particles are lost: the ranks are out of step";
  try {
    write_vtp(file, *particle_data(simulation_.liquid().record().particles));
  } catch (const IoError& error) {
    return fmt::format("its particles are lost: {}", error.what());
  }
  return fmt::format("its particles{} are in {}", simulation_.liquid().tells_all() ? "" : " near the surface",
                     file.string());
}

}  // namespace kappaflow
