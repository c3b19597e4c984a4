#include "tools/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "scenes/shapes.h"
#include "surface/tracker/initial_mesh.h"

namespace kappaflow {
namespace {

// Times that differ by less are the same: rounding in the solver's sum of time steps [s].
constexpr double kTimeTolerance = 1e-12;

FluidSolver make_fluid(const Scene& scene, std::span<const TriangleSurface> walls) {
  const FluidParticlesAtStart start = fill_blocks(scene);
  return {scene.fluid, start.position, start.velocity, walls, wall_motions(scene), start.fluid};
}

/// A cube of liquid of which more than half is further than sigma from the faces. The liquid with which an
/// emitter begins is too thin to say what the field will be inside of it.
std::vector<Vec3> mostly_interior_lattice(const Scene& scene) {
  const double edge = std::ceil(12 * scene.surface.sigma) * scene.fluid.spacing;
  return lattice_points(BoxShape{Vec3::Zero(), Vec3::Constant(edge)}, scene.fluid.spacing);
}

ParticleFieldOptions make_field_options(const Scene& scene, const Particles& particles) {
  ParticleFieldOptions options;
  options.sigma = scene.surface.sigma * scene.fluid.spacing;
  options.weights = scene.surface.weights;
  options.threshold = scene.surface.threshold.value_or(0);
  if (!scene.surface.threshold) {
    const std::vector<Vec3> liquid =
        scene.fluid.emitters.empty() ? particles.position : mostly_interior_lattice(scene);
    const std::vector<double> weights = field_weights(liquid, options.sigma, options.weights);
    options.threshold = half_median_threshold(liquid, weights, options.sigma);
  }
  return options;
}

std::vector<SurfaceTracker> make_trackers(const Scene& scene, const Field& field, double sigma) {
  const TriangleMesh mesh =
      initial_mesh(field, scene.surface.edge_length * sigma, scene.surface.tracker.projection);
  if (mesh.triangles.empty())
    throw InvalidInput(fmt::format("{}: the surface is empty: Eq. 12 stays below the threshold everywhere",
                                   scene.file.string()));
  std::vector<SurfaceTracker> trackers;
  trackers.reserve(scene.surface.methods.size());
  for (const std::string& method : scene.surface.methods) {
    TrackerOptions options = scene.surface.tracker;
    options.method = method;
    options.remeshing.edge_length = scene.surface.remesh ? scene.surface.edge_length * sigma : 0;
    options.topology.follows_field = scene.surface.topology;
    trackers.emplace_back(mesh, options);
  }
  return trackers;
}

}  // namespace

Simulation::Simulation(const Scene& scene)
    : walls_(wall_surfaces(scene)),
      fluid_(make_fluid(scene, walls_)),
      particles_(fluid_.particles()),
      field_options_(make_field_options(scene, particles_)),
      field_(particle_field(particles_, field_options_)),
      trackers_(make_trackers(scene, *field_, field_options_.sigma)),
      tracers_(trackers_.front().mesh().position),
      stride_(scene.surface.stride) {
  take_since_frame();
}

bool Simulation::advance(double time, const Watch& watch) {
  int untracked = 0;
  while (time - fluid_.time() > kTimeTolerance) {
    const Stopwatch watch_solver;
    const FluidStep step = fluid_.step(time - fluid_.time());
    for (PhaseSeconds& seconds : since_frame_.seconds) seconds.solver += watch_solver.seconds();
    since_frame_.density_error_mean = std::max(since_frame_.density_error_mean, step.density_error_mean);
    since_frame_.density_error_max = std::max(since_frame_.density_error_max, step.density_error_max);
    ++steps_;
    if (++untracked == stride_) {
      step_surfaces();
      untracked = 0;
    }
    if (!watch(step)) return false;
  }
  if (untracked > 0) step_surfaces();
  return true;
}

void Simulation::step_surfaces() {
  Particles now = fluid_.particles();
  ParticleMotion motion(particles_, now, field_options_);
  for (std::size_t m = 0; m < trackers_.size(); ++m) {
    const TrackerStep step = trackers_[m].step(motion);
    since_frame_.residual_max[m] = std::max(since_frame_.residual_max[m], step.residual_max);
    since_frame_.seconds[m].velocity += step.velocity_seconds;
    since_frame_.seconds[m].fairing += step.fairing_seconds;
    since_frame_.seconds[m].topology += step.topology_seconds;
    since_frame_.seconds[m].remesh += step.remesh_seconds;
    since_frame_.topology[m] += step.topology;
  }
  const Stopwatch watch;
  tracers_.step(motion);
  since_frame_.tracer_seconds += watch.seconds();
  field_ = motion.at(motion.t1());
  particles_ = std::move(now);
}

SinceFrame Simulation::take_since_frame() {
  SinceFrame fresh;
  fresh.residual_max.assign(trackers_.size(), 0);
  fresh.topology.assign(trackers_.size(), {});
  fresh.seconds.assign(trackers_.size(), {});
  return std::exchange(since_frame_, std::move(fresh));
}

}  // namespace kappaflow
