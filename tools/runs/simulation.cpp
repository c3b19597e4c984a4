#include "tools/runs/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/stopwatch.h"
#include "core/whole_within.h"
#include "scenes/shapes.h"
#include "solver/wall_bodies.h"

namespace kappaflow {
namespace {

// Times that differ by less are the same: rounding in the solver's sum of time steps [s].
constexpr double kTimeTolerance = 1e-12;
constexpr double kRepairPath = 0.8;  // of a particle from one repair of the mesh to the next [spacing]

/// A cube of liquid of which more than half is further than sigma from the faces. The liquid with which an
/// emitter begins is too thin to say what the field will be inside of it.
std::vector<Vec3> mostly_interior_lattice(const Scene& scene) {
  const double edge = std::ceil(12 * scene.surface.sigma) * scene.fluid.spacing;
  return lattice_points(BoxShape{Vec3::Zero(), Vec3::Constant(edge)}, scene.fluid.spacing);
}

/// When a step of the surfaces is due, the simulation decides.
SurfaceOptions surface_options(const Scene& scene) {
  SurfaceOptions options = scene.surface;
  options.spacing = scene.fluid.spacing;
  options.velocities = surface_methods_named(scene.surface.methods);
  options.motion_per_step = kInfinity;
  options.name = scene.file.string();
  if (!scene.fluid.emitters.empty())
    options.threshold = field_options(options, mostly_interior_lattice(scene)).threshold;
  options.tracker.repair_interval =
      whole_within(std::round(kRepairPath / (scene.surface.motion_per_step * scene.surface.sigma)), 1,
                   std::numeric_limits<int>::max());
  return options;
}

}  // namespace

FluidSolver make_fluid(const Scene& scene, FluidParticlesAtStart&& particles,
                       std::span<const SolidWall> walls, std::span<const RigidBody> bodies, Ranks* ranks) {
  FluidParticlesAtStart start = std::move(particles);
  if (ranks != nullptr && ranks->rank() > 0) start = {};  // they come from the first
  return {scene.fluid,  start.position,    start.velocity, walls, start.fluid,
          start.source, start.temperature, bodies,         ranks};
}

int last_frame_of(const Scene& scene) {
  return static_cast<int>(std::ceil(scene.duration * scene.output.frames_per_second - 1e-9));
}

double frame_time(const Scene& scene, int frame) {
  return std::min(frame / scene.output.frames_per_second, scene.duration);
}

Simulation::Simulation(PreparedScene prepared, Ranks* ranks)
    : walls_(std::move(prepared.walls)),
      bodies_(all_solids({}, prepared.bodies)),
      fluid_(make_fluid(prepared.scene, std::move(prepared.start), walls_, prepared.bodies, ranks)),
      surfaces_(fluid_.particles(), surface_options(prepared.scene)),
      tracers_(prepared.scene.output.metrics_interval > 0 ? std::span<const Vec3>(surfaces_.mesh().position)
                                                          : std::span<const Vec3>()),
      motion_per_step_(prepared.scene.surface.motion_per_step * surfaces_.field_options().sigma),
      flows_in_(!prepared.scene.fluid.emitters.empty()) {
  surfaces_.find_sources(fluid_.sources());
}

bool Simulation::advance(double time, const Watch& watch) {
  while (time - fluid_.time() > kTimeTolerance) {
    const Stopwatch watch_solver;
    const FluidStep step = fluid_.step(time - fluid_.time());
    report_.solver_seconds += watch_solver.seconds();
    report_.density_error_mean = std::max(report_.density_error_mean, step.density_error_mean);
    report_.density_error_max = std::max(report_.density_error_max, step.density_error_max);
    report_.viscosity_error = std::max(report_.viscosity_error, step.viscosity_error);
    Particles now = fluid_.particles();
    if (!surfaces_wait(now, step.time_step) || !(time - fluid_.time() > kTimeTolerance))
      step_surfaces(std::move(now));
    if (!watch(step) && time - fluid_.time() > kTimeTolerance) return false;
  }
  surfaces_.settle(fluid_.sources(), flows_in_);
  return true;
}

/// Whether fast particles may go one more step of the liquid like the last one before the surfaces follow.
bool Simulation::surfaces_wait(const Particles& now, double time_step) {
  const double way = fast_speed(now) * time_step;
  untracked_ += way;
  return untracked_ + way <= motion_per_step_;
}

void Simulation::step_surfaces(Particles now) {
  surfaces_.step(std::move(now), [this](FieldMotion& step) {
    report_.tracer_seconds += seconds_of([&] { tracers_.step(step); });
    return true;
  });
  untracked_ = 0;
}

std::vector<SolidWall> Simulation::solids_at_start() const {
  std::vector<SolidWall> solids = walls_at(0, walls_);
  solids.insert(solids.end(), bodies_.begin(), bodies_.end());
  return solids;
}

std::vector<SolidWall> Simulation::solids_now() const {
  std::vector<SolidWall> solids = walls_at(fluid_.time(), walls_);
  const std::vector<BodyState> states = fluid_.bodies();
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    solids.emplace_back(moved(bodies_[b].surface(), states[b].pose));
  return solids;
}

SimulationReport Simulation::take_report() {
  SimulationReport report = std::exchange(report_, {});
  report.surfaces = surfaces_.take_report();
  return report;
}

}  // namespace kappaflow
