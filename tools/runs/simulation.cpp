#include "tools/runs/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/whole_within.h"
#include "scenes/shapes.h"

namespace kappaflow {
namespace {

// Times that differ by less are the same: rounding in the solver's sum of time steps [s].
constexpr double kTimeTolerance = 1e-12;
constexpr double kMendingPath = 0.8;  // of a particle from one mending of the mesh to the next [spacing]

FluidSolver make_fluid(const Scene& scene, std::span<const TriangleSurface> walls) {
  const FluidParticlesAtStart start = fill_blocks(scene);
  return {scene.fluid, start.position, start.velocity, walls, wall_motions(scene), start.fluid, start.source};
}

/// A cube of liquid of which more than half is further than sigma from the faces. The liquid with which an
/// emitter begins is too thin to say what the field will be inside of it.
std::vector<Vec3> mostly_interior_lattice(const Scene& scene) {
  const double edge = std::ceil(12 * scene.surface.sigma) * scene.fluid.spacing;
  return lattice_points(BoxShape{Vec3::Zero(), Vec3::Constant(edge)}, scene.fluid.spacing);
}

TrackedSurfaces make_surfaces(const Scene& scene, const Particles& particles) {
  const std::vector<Vec3> liquid =
      scene.fluid.emitters.empty() ? particles.position : mostly_interior_lattice(scene);
  const ParticleFieldOptions options = field_options(scene.surface, scene.fluid.spacing, liquid);
  SurfaceDescription surface = scene.surface;
  surface.tracker.mending_interval =
      whole_within(kMendingPath / (scene.fluid.cfl * surface.stride), 1, std::numeric_limits<int>::max());
  return {particle_field(particles, options), options, surface, scene.file.string()};
}

}  // namespace

Simulation::Simulation(const Scene& scene)
    : walls_(wall_surfaces(scene)),
      fluid_(make_fluid(scene, walls_)),
      particles_(fluid_.particles()),
      surfaces_(make_surfaces(scene, particles_)),
      stride_(scene.surface.stride) {
  find_sources();
}

bool Simulation::advance(double time, const Watch& watch) {
  while (time - fluid_.time() > kTimeTolerance) {
    const Stopwatch watch_solver;
    const FluidStep step = fluid_.step(time - fluid_.time());
    since_frame_.solver_seconds += watch_solver.seconds();
    since_frame_.density_error_mean = std::max(since_frame_.density_error_mean, step.density_error_mean);
    since_frame_.density_error_max = std::max(since_frame_.density_error_max, step.density_error_max);
    if (++untracked_ == stride_) step_surfaces();
    if (!watch(step) && time - fluid_.time() > kTimeTolerance) return false;
  }
  if (untracked_ > 0) step_surfaces();
  surfaces_.settle();
  find_sources();
  return true;
}

void Simulation::step_surfaces() {
  Particles now = fluid_.particles();
  ParticleMotion motion(particles_, now, surfaces_.field_options());
  surfaces_.step(motion);
  particles_ = std::move(now);
  untracked_ = 0;
}

void Simulation::find_sources() {
  surfaces_.find_sources(particles_.position, fluid_.sources());
}

SinceFrame Simulation::take_since_frame() {
  SinceFrame since = std::exchange(since_frame_, {});
  since.surfaces = surfaces_.take_since_frame();
  for (PhaseSeconds& seconds : since.surfaces.seconds) seconds.solver = since.solver_seconds;
  return since;
}

}  // namespace kappaflow
