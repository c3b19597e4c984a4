// Simple models, their constants in one place.
#include "scenes/estimate.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/named.h"
#include "core/whole_within.h"
#include "scenes/shapes.h"
#include "solver/emitter.h"
#include "solver/surface_tension.h"
#include "solver/time_step.h"

namespace kappaflow {
namespace {

// Bytes; Run.TakesTheMemoryThatWasEstimated (tests/tools) holds the sum against the program.
constexpr double kBytesOfProgram = 40e6;           // with its libraries
constexpr double kBytesPerParticleInSolver = 450;  // what `kappaflow benchmark` measures, rounded up
constexpr double kBytesPerParticleOfHeat = 80;     // in scenes that have it: the temperatures and their solve
constexpr double kBytesPerParticleCollected = 80;  // from ranks that share the liquid
constexpr double kBytesPerParticleTold = 400;      // by those that have it to one that has none
constexpr double kBytesPerParticleSaved = 200;     // of all, on their way to a checkpoint, where few are told
constexpr double kBytesPerSampledParticle = 900;   // of a wall, while the walls are sampled
// Particles at both ends of a step, the paths between them, and the fields of up to three stages, all in
// double precision.
constexpr double kBytesPerParticleInField = 2 * 56 + 112 + 3 * 80;
constexpr double kBytesPerBoundaryParticle = 64;
// Mesh, rings, springs, velocities of the stages, what edits, comparisons and reports need meanwhile.
constexpr double kBytesPerVertex = 2250;
// The reference isosurface: a lattice [sigma] over the box around the liquid, which grows to a multiple of
// its volume; the values and the extractor's copy.
constexpr double kSampleSpacing = 0.25;
constexpr double kSpread = 8;
constexpr double kBytesPerSample = 8;

// Per spacing^2 of wall: a Poisson-disk set 0.6 spacings apart.
constexpr double kBoundaryParticlesPerCell = 1.9;
// Seconds on one core of an AMD EPYC that runs other programs beside it (docs/performance.md); sigma of 2
// spacings where nothing else is said.
constexpr double kSecondsPerBoundaryParticle = 8e-6;  // sampling the walls
constexpr double kSecondsPerFirstVertex = 1e-4;       // meshing
constexpr double kSolverSecondsPerParticleStep = 1.4e-6;
constexpr double kSecondsPerViscousIteration = 0.11e-6;  // and particle
constexpr double kSecondsPerFairing = 0.3e-6;            // a vertex and step: projection
constexpr double kSecondsPerFairingIteration = 0.32e-6;  // and relaxation
constexpr double kSecondsPerRemeshing = 1.2e-6;  // likewise: remeshing, and looking for changes of topology
constexpr double kSecondsPerRegion = 6.5e-3;     // a change of topology, with the comparison after it
constexpr double kSecondsPerRegionVertex = 0.6e-6;  // the same of a stream's mesh of so many vertices
constexpr double kSecondsPerFreshVertex =
    8e-6;  // a frame: meshing it anew, and where its liquid has come from
constexpr double kSecondsPerGridPoint = 14e-6;      // a step of fresh-grid
constexpr double kOutputSecondsPerParticle = 2e-6;  // a frame
constexpr double kOutputSecondsPerVertex = 20e-6;   // a frame and method, measures included
constexpr double kParallelShare = 0.9;              // of all but output (Amdahl 1967)
constexpr double kSharedByRanks = 0.6;              // of a step of tracked surfaces: docs/scaling.md
constexpr int kMostSpans = 10000;                   // of time that are looked at one by one

/// Seconds of a velocity at a vertex.
constexpr Named<double> kVelocitySeconds[] = {
    {"normal", 0.25e-6},         {"total", 0.45e-6},   {"curvature", 0.55e-6}, {"curvature-only", 0.55e-6},
    {"curvature-first", 0.7e-6}, {"material", 0.4e-6}, {"regional", 1.8e-6}};

// Anisotropic kernels take this many times round ones' time in velocities, fairing and topology.
constexpr double kAnisotropicTimes = 1.8;

// The flow. The fastest particle of liquid that runs down somewhere has about this share of the largest speed
// that free fall allows, in the mean; a stream falls all the time; torn liquid squirts.
constexpr double kTypicalSpeedShare = 0.6, kTypicalStreamShare = 0.7, kLargestSpeedShare = 1.1;
// Conjugate gradients for viscosity: 1 + 3 sqrt(nu dt / h^2), and at most 4; setting them up takes as long as
// 4 more.
constexpr double kFewestViscous = 1, kMoreViscous = 3, kMostViscous = 4, kViscousSetUp = 4;

// The surface. Vertices per edge^2: of a smooth surface that moves, and of one in shreds, where rims and tips
// take finer edges. Weights that are not normalised leave the thinnest shreds without a surface.
constexpr double kVerticesPerCell = 1.5, kVerticesPerShred = 3, kVerticesPerNormalisedShred = 5;
// Area over volume^(2/3) of what a stream piles up: of a half ball, of honey at a Reynolds number of 1 and
// what each e-folding of that adds, of a puddle in folds.
constexpr double kHalfBall = 5.8, kPile = 9, kSpreading = 2.8, kPuddle = 14;

// Splashing, fitted to a breaking dam and to a ball that falls into a pool: see splash_of().
constexpr double kSplashShare = 0.6;
constexpr double kCalm = 20,
                 kWild = 300;      // Reynolds numbers below which nothing splashes and above which all may
constexpr double kSplashPeak = 3;  // when, in units of when it begins
// Of changes of topology, see topology_seconds(). Those of a stream grow with the Reynolds number up to here.
constexpr double kRegionsPerMotion = 0.07, kStreamRegionsPerMotion = 7e-5;
constexpr double kFoldingPower = 0.8, kMostFolding = 30;

/// What is the same at every moment of the run, of a scene and its walls.
struct Flow {
  double block_area = 0;     // of the liquid's blocks [m2]
  double fastest_start = 0;  // [m/s]
  double fastest = 0;        // after the deepest possible fall [m/s]
  double energy = 0;         // that the liquid has to give until it is at rest on the floor [J/kg]
  double depth = 0;          // of the liquid on the floor; 0: there is no floor [m]
  double floor = 0;          // its potential [m2/s2]
  double reynolds = 0;       // of its speed then and that depth
  double splash = 0;         // share of the liquid that is in shreds when it splashes most
};

double potential(const Scene& scene, const Vec3& x) {
  return -scene.fluid.gravity.dot(x);
}

/// The lowest faces of the walls on which liquid can lie.
struct Floor {
  double potential = INFINITY;  // [m2/s2]
  double area = 0;              // [m2]
};

Floor lowest_floor(const Scene& scene, std::span<const SolidWall> walls) {
  constexpr double kLevel = 0.7;  // cosine of the slope
  const Vec3 up = -scene.fluid.gravity.normalized();
  const double same_level = scene.fluid.gravity.norm() * scene.fluid.spacing;
  Floor floor;
  for (const SolidWall& wall : walls)
    for (const auto& [a, b, c] : wall.surface().triangles) {
      const std::vector<Vec3>& x = wall.surface().vertices;
      const Vec3 &p = x[a], &q = x[b], &r = x[c];
      const Vec3 twice_area = (q - p).cross(r - p);
      const double upward = up.dot(twice_area), level = potential(scene, (p + q + r) / 3);
      if (upward < kLevel * twice_area.norm() || level > floor.potential + same_level) continue;
      if (level < floor.potential - same_level) floor.area = 0;
      floor.potential = std::min(floor.potential, level);
      floor.area += upward / 2;
    }
  return floor;
}

/// The particles of an emitter by `time` [s].
double emitted_by(const Emitter& emitter, const Scene& scene, double time) {
  const double end = std::min(emitter.end, scene.duration);
  if (!(end > emitter.start)) return 0;
  return emitted_particles(emitter, scene) *
         std::clamp((time - emitter.start) / (end - emitter.start), 0.0, 1.0);
}

/// The mean over all liquid of what it brings with it, kinetic and potential [J/kg], less what it keeps.
double energy_to_give(const Scene& scene, const FluidParticlesAtStart& start, const Flow& flow) {
  double sum = 0, particles = 0;
  const auto add = [&](double speed, const Vec3& x, double count) {
    sum += count * (0.5 * speed * speed + potential(scene, x) - flow.floor);
    particles += count;
  };
  for (std::size_t i = 0; i < start.position.size(); ++i) add(start.velocity[i].norm(), start.position[i], 1);
  for (const Emitter& emitter : scene.fluid.emitters)
    add(emitter.mean_speed(emitter.start, std::max(emitter.start, std::min(emitter.end, scene.duration))),
        emitter.position, emitted_particles(emitter, scene));
  return std::max(0.0, sum / particles - 0.5 * scene.fluid.gravity.norm() * flow.depth);
}

/// Of the thinnest fluid.
double reynolds_of(const Scene& scene, const Flow& flow) {
  double viscosity = scene.fluid.viscosity(0);
  for (std::size_t fluid = 1; fluid < scene.fluid.fluids(); ++fluid)
    viscosity = std::min(viscosity, scene.fluid.viscosity(fluid));
  return std::sqrt(2 * flow.energy) * flow.depth / std::max(viscosity, 1e-12);
}

/// Liquid is torn the more the higher its energy could lift it, in units of its depth at rest, unless
/// viscosity damps it before.
double splash_of(const Scene& scene, const Flow& flow) {
  const double wild = std::clamp(std::log(flow.reynolds / kCalm) / std::log(kWild / kCalm), 0.0, 1.0);
  return wild * std::min(1.0, kSplashShare * flow.energy / (scene.fluid.gravity.norm() * flow.depth));
}

/// particles: all that there will be.
Flow flow_of(const PreparedScene& prepared, double particles) {
  const Scene& scene = prepared.scene;
  const FluidParticlesAtStart& start = prepared.start;
  Flow flow;
  flow.block_area = prepared.block_area;
  double highest = -INFINITY;
  for (std::size_t i = 0; i < start.position.size(); ++i) {
    flow.fastest_start = std::max(flow.fastest_start, start.velocity[i].norm());
    highest = std::max(highest, potential(scene, start.position[i]));
  }
  for (const Emitter& emitter : scene.fluid.emitters) {
    flow.fastest_start = std::max(flow.fastest_start, emitter.largest_speed(emitter.start, scene.duration));
    highest = std::max(highest, potential(scene, emitter.position));
  }
  const Floor floor = lowest_floor(scene, prepared.walls);
  flow.fastest = INFINITY;
  if (!(floor.area > 0)) return flow;
  flow.floor = floor.potential;
  flow.fastest =
      std::sqrt(flow.fastest_start * flow.fastest_start + 2 * std::max(0.0, highest - floor.potential));
  flow.depth = particles * std::pow(scene.fluid.spacing, 3) / floor.area;
  flow.energy = energy_to_give(scene, start, flow);
  flow.reynolds = reynolds_of(scene, flow);
  flow.splash = splash_of(scene, flow);
  return flow;
}

/// Of the fastest particles at `time` [m/s].
double speed_at(double time, const Scene& scene, const Flow& flow) {
  const FluidOptions& fluid = scene.fluid;
  const double calm = fluid.emitters.empty() ? kTypicalSpeedShare : kTypicalStreamShare;
  const double share = std::min(calm + flow.splash, kLargestSpeedShare);
  return share * std::min(flow.fastest, flow.fastest_start + fluid.gravity.norm() * time);
}

/// The length of a step at that speed, without regard to frames [s].
double time_step_at(double speed, const Scene& scene) {
  const FluidOptions& fluid = scene.fluid;
  const double step =
      std::min({cfl_time_step(speed, fluid.gravity.norm(), fluid.cfl * fluid.spacing),
                capillary_time_step(fluid.surface_tension, fluid.least_density(), fluid.spacing),
                fluid.max_time_step});
  return std::max(step, fluid.min_time_step);
}

double particles_at(double time, const Scene& scene, const FluidParticlesAtStart& start) {
  double particles = static_cast<double>(start.position.size());
  for (const Emitter& emitter : scene.fluid.emitters) particles += emitted_by(emitter, scene, time);
  return particles;
}

/// Of a stream as far as it has fallen, and of what it has piled up.
double stream_area(const Emitter& emitter, double time, const Scene& scene, const Flow& flow) {
  const double spacing = scene.fluid.spacing, g = scene.fluid.gravity.norm();
  const double since = std::min(time, emitter.end) - emitter.start;
  if (since < 0) return 0;
  const double mouth = static_cast<double>(emitter_layer(emitter, spacing).size()) * spacing * spacing;
  double length = way_of_stream(emitter, 1, emitter.start + since) + 0.5 * g * since * since;
  if (flow.depth > 0)
    length = std::min(length, std::max(0.0, potential(scene, emitter.position) - flow.floor) / g);
  const double volume = emitted_by(emitter, scene, time) * std::pow(spacing, 3),
               piled_up = std::max(0.0, volume - mouth * length);
  const double shape = std::clamp(kPile + kSpreading * std::log(flow.reynolds), kHalfBall, kPuddle);
  return 2 * mouth + (kNozzleLength * spacing + length) * 4 * std::sqrt(mouth) +
         shape * std::pow(piled_up, 2.0 / 3.0);
}

/// Edge^2 of the mesh [m2].
double cell_area(const Scene& scene) {
  const double edge = scene.surface.edge_length * scene.surface.sigma * scene.fluid.spacing;
  return edge * edge;
}

double smooth_vertices(double time, const Scene& scene, const Flow& flow) {
  double total = flow.block_area;
  for (const Emitter& emitter : scene.fluid.emitters) total += stream_area(emitter, time, scene, flow);
  return kVerticesPerCell * total / cell_area(scene);
}

/// Of what has been torn: nothing until the liquid could have fallen as deep as its energy says, then soon
/// the most, which a stream keeps up and a single fall does not.
double torn_vertices(double time, double particles, const Scene& scene, const Flow& flow) {
  if (!(flow.splash > 0) || !scene.surface.remesh || !scene.surface.topology) return 0;
  const double begin = std::sqrt(2 * flow.energy) / scene.fluid.gravity.norm();
  const double progress = std::max(0.0, time / begin - 1) / (kSplashPeak);
  const double risen = progress >= 1 && !scene.fluid.emitters.empty() ? 1 : progress * std::exp(1 - progress);
  const double density =
      scene.surface.weights == WeightRule::normalised ? kVerticesPerNormalisedShred : kVerticesPerShred;
  return density * flow.splash * risen * particles * scene.fluid.spacing * scene.fluid.spacing /
         cell_area(scene);
}

int stages(TimeIntegrator integrator) {
  return integrator == TimeIntegrator::euler ? 1 : integrator == TimeIntegrator::rk2 ? 2 : 4;
}

/// What grows with the particles within sigma.
double neighbourhood(const Scene& scene) {
  return std::pow(scene.surface.sigma / 2, 3);
}

double velocity_seconds(const Scene& scene, std::string_view method) {
  for (const Named<double>& known : kVelocitySeconds)
    if (known.name == method) return known.value * (method == "regional" ? 1 : neighbourhood(scene));
  return 1e-6;
}

bool is_tracked(std::string_view method) {
  return !method.starts_with("fresh-");
}

double kernel_times(const Scene& scene) {
  return scene.surface.kernels == Kernels::anisotropic ? kAnisotropicTimes : 1;
}

/// A step of all tracked surfaces at a vertex.
double tracker_seconds_per_vertex(const Scene& scene) {
  const TrackerOptions& tracker = scene.surface.tracker;
  const double fairing = (kSecondsPerFairing + tracker.fairing.iterations * kSecondsPerFairingIteration) *
                         std::sqrt(neighbourhood(scene));
  double total = 0;
  for (const std::string& method : scene.surface.methods)
    if (is_tracked(method))
      total +=
          kernel_times(scene) * (stages(tracker.integrator) * velocity_seconds(scene, method) + fairing) +
          (scene.surface.remesh ? kSecondsPerRemeshing : 0);
  return total;
}

/// A step of the grids that carry textures, for each particle: their points fill the liquid.
double grid_seconds_per_particle(const Scene& scene) {
  const double spacing = scene.surface.edge_length * scene.surface.sigma;  // of the points, in the particles'
  const auto grids = static_cast<double>(std::ranges::count(scene.surface.methods, "fresh-grid"));
  return grids * kSecondsPerGridPoint * std::pow(spacing, -3);
}

/// Changes of topology of one surface for a second of simulated time. Shreds part and meet the oftener the
/// faster the liquid moves, in sizes of its body; a stream folds, by spacings.
double topology_seconds(double smooth, double torn, double particles, const Scene& scene, const Flow& flow) {
  if (!scene.surface.remesh || !scene.surface.topology) return 0;
  const double motion = std::sqrt(2 * flow.energy) / scene.fluid.spacing;
  const double folding =
      scene.fluid.emitters.empty()
          ? 0
          : kStreamRegionsPerMotion * std::pow(std::min(flow.reynolds, kMostFolding), kFoldingPower);
  return kernel_times(scene) * motion *
         (kSecondsPerRegion * kRegionsPerMotion * torn / std::cbrt(std::max(1.0, particles)) +
          kSecondsPerRegionVertex * folding * smooth * smooth);
}

/// With the time of setting up in units of an iteration's.
double viscous_iterations(double step, const Scene& scene) {
  const double h = scene.fluid.spacing;
  double viscosity = 0;
  for (std::size_t fluid = 0; fluid < scene.fluid.fluids(); ++fluid)
    viscosity = std::max(viscosity, scene.fluid.viscosity(fluid));
  if (!(viscosity > 0)) return 0;
  const double needed =
      std::min(kFewestViscous + kMoreViscous * std::sqrt(viscosity * step) / h, kMostViscous);
  return std::min(needed, static_cast<double>(scene.fluid.max_viscosity_iterations)) + kViscousSetUp;
}

/// What the run does and how long that takes, summed up frame by frame.
void add_work(const Scene& scene, const FluidParticlesAtStart& start, const Flow& flow, int threads,
              SceneEstimate& result) {
  const double frame_time = 1 / scene.output.frames_per_second,
               methods = static_cast<double>(scene.surface.methods.size()),
               tracked = static_cast<double>(std::ranges::count_if(scene.surface.methods, is_tracked)),
               first = smooth_vertices(0, scene, flow), vertex_step = tracker_seconds_per_vertex(scene);
  double liquid = static_cast<double>(result.boundary_particles) * kSecondsPerBoundaryParticle,
         surfaces = first * kSecondsPerFirstVertex, tracker = 0, output = 0;
  const double frames = std::ceil(scene.duration / frame_time - 1e-9);
  const double motion_per_step = scene.surface.motion_per_step * scene.surface.sigma * scene.fluid.spacing;
  const int spans = whole_within<int>(frames, 1, kMostSpans);  // of a frame each, as a rule
  const double lasting = scene.duration / spans;
  for (int span = 0; span < spans; ++span) {
    const double middle = (span + 0.5) * lasting;
    const double speed = speed_at(middle, scene, flow),
                 steps = std::ceil(lasting / time_step_at(speed, scene) - 1e-9);
    const double particles = particles_at(middle, scene, start);
    const double smooth = smooth_vertices(middle, scene, flow),
                 torn = torn_vertices(middle, particles, scene, flow), vertices = smooth + torn;
    const double tracker_steps = std::max(frames / spans, std::min(lasting * speed / motion_per_step, steps));
    result.steps += steps;
    result.particle_steps += steps * particles;
    result.vertices = std::max(result.vertices, vertices);
    liquid += steps * particles *
              (kSolverSecondsPerParticleStep +
               viscous_iterations(lasting / steps, scene) * kSecondsPerViscousIteration);
    tracker += tracker_steps * vertices * vertex_step;
    surfaces += tracker_steps * particles * grid_seconds_per_particle(scene) +
                tracked * lasting * topology_seconds(smooth, torn, particles, scene, flow) +
                (methods - tracked) * frames / spans * vertices * kSecondsPerFreshVertex;
    surfaces += tracker_steps * first * stages(scene.surface.tracker.integrator) *
                velocity_seconds(scene, "material");
    output += frames / spans *
              (particles * kOutputSecondsPerParticle + methods * vertices * kOutputSecondsPerVertex);
  }
  const double share = 1 - kParallelShare + kParallelShare / threads;
  result.liquid_seconds = liquid * share;
  result.tracker_seconds = tracker * share;
  result.seconds = (liquid + surfaces + tracker) * share + output;
}

/// As a number of things, at most 2^53: of walls a million kilometres long there would be more.
std::size_t whole_count(double number) {
  return whole_within<std::size_t>(number, 0, std::size_t{1} << 53);
}

/// Where so many of the ranks follow the surfaces.
double seconds_with_ranks(const SceneEstimate& cost, int ranks, int surfaces) {
  const double rest = cost.seconds - cost.liquid_seconds;
  if (surfaces == 0) return rest + cost.liquid_seconds / ranks;
  const double shared = kSharedByRanks * cost.tracker_seconds;
  return std::max(cost.liquid_seconds / (ranks - surfaces), rest - shared + shared / surfaces);
}

/// Those within 4.5 sigma of a surface with so many vertices, and one of eight in the depth: see Zone.
double near_particles(const Scene& scene, double particles, double vertices) {
  const double sigma = scene.surface.sigma, edge = scene.surface.edge_length * sigma;  // [spacings]
  const double area = vertices / kVerticesPerCell * edge * edge;
  return std::min(particles, 4.5 * sigma * area + particles / 8);
}

}  // namespace

int ranks_for_surfaces(const SceneEstimate& cost, int ranks) {
  constexpr double kLeastGain = 0.03;  // [1] of one more
  const auto seconds = [&](int surfaces) { return seconds_with_ranks(cost, ranks, surfaces); };
  if (ranks < 2 || seconds(1) >= seconds(0)) return 0;
  int surfaces = 1;
  while (surfaces + 1 < ranks && seconds(surfaces + 1) < (1 - kLeastGain) * seconds(surfaces)) ++surfaces;
  return surfaces;
}

std::size_t memory_with_ranks(const Scene& scene, const SceneEstimate& cost, const LiquidPlace& place) {
  const double particles = static_cast<double>(cost.particles) + static_cast<double>(cost.emitted),
               boundary_particles = static_cast<double>(cost.boundary_particles);
  const double methods = static_cast<double>(scene.surface.methods.size());
  const double sample = kSampleSpacing * scene.surface.sigma;  // [spacings]
  const double heat = scene.fluid.heat ? kBytesPerParticleOfHeat : 0;
  const double collected = place.is_near             ? place.tellers * kBytesPerParticleSaved
                           : place.surface_ranks > 0 ? 0
                           : place.share < 1         ? kBytesPerParticleCollected
                                                     : 0;
  const double in_solver = place.share * (kBytesPerParticleInSolver + heat) + collected;
  const double told = place.is_near ? near_particles(scene, particles, cost.vertices) : particles;
  const double in_field = kBytesPerParticleInField + (place.surface_ranks > 0 ? kBytesPerParticleTold : 0);
  const double samples = methods > 0 ? kSpread * told / (sample * sample * sample) : 0;
  const double followed =
      told * in_field + methods * cost.vertices * kBytesPerVertex + samples * kBytesPerSample;
  const double run = particles * in_solver + std::max(1, place.surface_ranks_here) * followed +
                     boundary_particles * kBytesPerBoundaryParticle;
  return whole_count(kBytesOfProgram + std::max(run, boundary_particles * kBytesPerSampledParticle));
}

SceneEstimate estimate(const PreparedScene& prepared, int threads) {
  const Scene& scene = prepared.scene;
  double wall_area = 0;
  for (const SolidWall& wall : prepared.walls) wall_area += surface_area(wall.surface());
  for (const RigidBody& body : prepared.bodies) wall_area += surface_area(body.solid.surface());
  const double particles = particles_at(scene.duration, scene, prepared.start);
  const double boundary = kBoundaryParticlesPerCell * wall_area / (scene.fluid.spacing * scene.fluid.spacing);
  SceneEstimate result;
  result.particles = prepared.start.position.size();
  result.emitted = whole_count(particles - static_cast<double>(result.particles));
  result.boundary_particles = whole_count(std::round(boundary));
  add_work(scene, prepared.start, flow_of(prepared, particles), threads, result);
  result.memory_bytes = memory_with_ranks(scene, result, {});
  return result;
}

}  // namespace kappaflow
