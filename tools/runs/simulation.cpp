#include "tools/runs/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/stopwatch.h"
#include "core/whole_within.h"
#include "scenes/shapes.h"
#include "solver/wall_bodies.h"
#include "tools/io/particle_sequence.h"

namespace kappaflow {
namespace {

constexpr double kRepairPath = 0.8;  // of a particle from one repair of the mesh to the next [spacing]

/// A cube of liquid of which more than half is further than sigma from the faces. The liquid with which an
/// emitter begins is too thin to say what the field will be inside of it, and those of large liquid that are
/// near its surface are hardly inside: it is the same whether these alone are told or all.
std::vector<Vec3> mostly_interior_lattice(const Scene& scene) {
  const double edge = std::ceil(12 * scene.surface.sigma) * scene.fluid.spacing;
  return lattice_points(BoxShape{Vec3::Zero(), Vec3::Constant(edge)}, scene.fluid.spacing);
}

/// When a step of the surfaces is due, the simulation decides.
SurfaceOptions surface_options(const Scene& scene, const Liquid& liquid) {
  SurfaceOptions options = scene.surface;
  options.spacing = scene.fluid.spacing;
  options.velocities = surface_methods_named(scene.surface.methods);
  options.motion_per_step = kInfinity;
  options.name = scene.file.string();
  if (!scene.fluid.emitters.empty() || !liquid.tells_all() || liquid.count() > ParticleChoice::kMany)
    options.threshold = field_options(options, mostly_interior_lattice(scene)).threshold;
  options.tracker.repair_interval =
      whole_within(std::round(kRepairPath / (scene.surface.motion_per_step * scene.surface.sigma)), 1,
                   std::numeric_limits<int>::max());
  return options;
}

TrackedSurfaces first_surfaces(const Scene& scene, const Liquid& liquid) {
  return together(liquid.surface_ranks(),
                  [&] { return TrackedSurfaces(liquid.particles(), surface_options(scene, liquid)); });
}

/// What the first of the ranks says.
bool of_first(Ranks* ranks, bool value) {
  if (ranks != nullptr) ranks->broadcast(bytes_in(std::span(&value, 1)));
  return value;
}

}  // namespace

Simulation::Simulation(PreparedScene prepared) : Simulation(prepared, own_liquid(prepared)) {}

Simulation::Simulation(const PreparedScene& prepared, std::unique_ptr<Liquid> liquid)
    : walls_(prepared.walls),
      bodies_(all_solids({}, prepared.bodies)),
      liquid_(std::move(liquid)),
      surfaces_(first_surfaces(prepared.scene, *liquid_)),
      tracers_(prepared.scene.output.metrics_interval > 0 ? std::span<const Vec3>(surfaces_.mesh().position)
                                                          : std::span<const Vec3>()),
      flows_in_(!prepared.scene.fluid.emitters.empty()) {
  surfaces_.find_sources(liquid_->sources());
}

bool Simulation::advance(double time, const Watch& watch) {
  while (!is_reached(liquid_->time(), time)) {
    LiquidStep step = liquid_->step(time, is_to_stop_);
    note(step);
    if (step.surfaces_follow)
      step_surfaces(is_reached(liquid_->time(), time) ? liquid_->particles() : std::move(step.now));
    is_to_stop_ = of_first(liquid_->surface_ranks(), !watch(step.last));
    if (is_to_stop_ && liquid_->can_be_saved() && !is_reached(liquid_->time(), time)) return false;
  }
  surfaces_.settle(liquid_->sources(), flows_in_);
  return true;
}

void Simulation::note(const LiquidStep& step) {
  report_.solver_seconds += step.seconds;
  report_.density_error_mean = std::max(report_.density_error_mean, step.last.density_error_mean);
  report_.density_error_max = std::max(report_.density_error_max, step.last.density_error_max);
  report_.viscosity_error = std::max(report_.viscosity_error, step.last.viscosity_error);
}

void Simulation::step_surfaces(Particles now) {
  surfaces_.step(std::move(now), [this](FieldMotion& step) {
    report_.tracer_seconds += seconds_of([&] { tracers_.step(step); });
    return true;
  });
}

std::vector<SolidWall> Simulation::solids_at_start() const {
  std::vector<SolidWall> solids = walls_at(0, walls_);
  solids.insert(solids.end(), bodies_.begin(), bodies_.end());
  return solids;
}

std::vector<SolidWall> Simulation::solids_now() const {
  std::vector<SolidWall> solids = walls_at(liquid_->time(), walls_);
  const std::vector<BodyState> states = liquid_->bodies();
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
