// What a run will need: simple models, their constants in one place.
#include <algorithm>
#include <cmath>

#include "core/whole_within.h"
#include "scenes/mesh_file.h"
#include "scenes/scene.h"
#include "scenes/shapes.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

// Bytes; Run.TakesTheMemoryThatWasEstimated (tests/tools) holds the sum against the program.
constexpr double kBytesOfProgram = 40e6;           // with its libraries
constexpr double kBytesPerParticleInSolver = 400;  // what `kappaflow benchmark` measures, rounded up
constexpr double kBytesPerSampledParticle = 900;   // of a wall, while the walls are sampled
// Particles at both ends of a step, the paths between them, and the fields of up to three stages, all in
// double precision.
constexpr double kBytesPerParticleInField = 2 * 56 + 112 + 3 * 80;
constexpr double kBytesPerBoundaryParticle = 64;
// Mesh, rings, springs, velocities of the stages, what edits, comparisons and reports need meanwhile.
constexpr double kBytesPerVertex = 1500;
// The reference isosurface: a lattice [sigma] over the box around the liquid, which grows to a multiple of
// its volume; the values and the extractor's copy.
constexpr double kSampleSpacing = 0.25;
constexpr double kSpread = 8;
constexpr double kBytesPerSample = 8;

// Per spacing^2 of wall: a Poisson-disk set 0.6 spacings apart.
constexpr double kBoundaryParticlesPerCell = 1.9;
// Of an isosurface per spacing^2 of area, averaged over directions; and the liquid's mean area over that of
// its blocks.
constexpr double kVerticesPerCell = 1.5;
constexpr double kSurfaceGrowth = 1.5;

// Seconds on one core.
constexpr double kSolverSecondsPerParticleStep = 2e-6;
constexpr double kTrackerSecondsPerVertexStage = 2e-6;      // a velocity
constexpr double kTrackerSecondsPerVertexFairing = 0.7e-6;  // one iteration with its projection
constexpr double kOutputSecondsPerParticle = 2e-6;          // a frame
constexpr double kOutputSecondsPerVertex = 10e-6;           // a frame and method, measures included
constexpr double kParallelShare = 0.9;                      // of the solver and the tracker (Amdahl 1967)

/// The flow's typical speed is about half the largest that free fall over the scene's drop allows.
constexpr double kTypicalSpeedShare = 0.5;

double area(const BoxShape& box) {
  const Vec3 d = box.upper - box.lower;
  return 2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
}
double area(const SphereShape& sphere) {
  return 4 * M_PI * sphere.radius * sphere.radius;
}

/// Of the mesh that the file holds, without checks: loading has made them.
double area(const MeshShape& mesh) {
  const TriangleSurface surface = mesh_surface(mesh, {});
  return area_and_volume(surface.vertices, surface.triangles).area;
}

double memory(const Scene& scene, double particles, double boundary_particles, double vertices) {
  const double methods = static_cast<double>(scene.surface.methods.size());
  const double sample = kSampleSpacing * scene.surface.sigma;  // [spacings]
  const double samples = methods > 0 ? kSpread * particles / (sample * sample * sample) : 0;
  const double run = particles * (kBytesPerParticleInSolver + kBytesPerParticleInField) +
                     boundary_particles * kBytesPerBoundaryParticle + methods * vertices * kBytesPerVertex +
                     samples * kBytesPerSample;
  return kBytesOfProgram + std::max(run, boundary_particles * kBytesPerSampledParticle);
}

/// Largest speed by the end [m/s]: free fall for the whole duration, but not further than from the highest
/// particle to the lowest point of the walls, if there are any.
double fastest_speed(const Scene& scene, const FluidParticlesAtStart& particles,
                     const std::vector<TriangleSurface>& walls) {
  const Vec3& gravity = scene.fluid.gravity;
  double fastest_start = 0, highest = -INFINITY, lowest = INFINITY;  // potentials -g . x [m2/s2]
  for (const Vec3& v : particles.velocity) fastest_start = std::max(fastest_start, v.norm());
  for (const Vec3& x : particles.position) highest = std::max(highest, -gravity.dot(x));
  for (const TriangleSurface& wall : walls)
    for (const Vec3& x : wall.vertices) lowest = std::min(lowest, -gravity.dot(x));
  for (const Emitter& emitter : scene.fluid.emitters) {
    fastest_start = std::max(fastest_start, emitter.speed);
    highest = std::max(highest, -gravity.dot(emitter.position));
  }
  const double by_time = fastest_start + gravity.norm() * scene.duration;
  if (walls.empty()) return by_time;
  const double by_drop = std::sqrt(fastest_start * fastest_start + 2 * std::max(0.0, highest - lowest));
  return std::min(by_time, by_drop);
}

double solver_steps(const Scene& scene, double fastest) {
  const FluidOptions& fluid = scene.fluid;
  const double typical = std::max(kTypicalSpeedShare * fastest, 1e-9);
  const double step =
      std::clamp(fluid.cfl * fluid.spacing / typical, fluid.min_time_step, fluid.max_time_step);
  return std::ceil(scene.duration / step);
}

/// Of the liquid in the nozzle at the start, where the mesh of a stream begins.
double nozzle_area(const Emitter& emitter, double spacing) {
  const double mouth = static_cast<double>(emitter_layer(emitter, spacing).size()) * spacing * spacing;
  return emitter.start > 0 ? 0 : 2 * mouth + kNozzleLength * spacing * 4 * std::sqrt(mouth);
}

double surface_vertices(const Scene& scene) {
  double total = 0;
  for (const FluidBlock& block : scene.blocks)
    total += std::visit([](const auto& shape) { return area(shape); }, block.shape);
  for (const Emitter& emitter : scene.fluid.emitters) total += nozzle_area(emitter, scene.fluid.spacing);
  const double edge = scene.surface.edge_length * scene.surface.sigma * scene.fluid.spacing;
  return kVerticesPerCell * kSurfaceGrowth * total / (edge * edge);
}

int stages(TimeIntegrator integrator) {
  return integrator == TimeIntegrator::euler ? 1 : integrator == TimeIntegrator::rk2 ? 2 : 4;
}

double tracker_seconds(const Scene& scene, double vertices, double steps) {
  const TrackerOptions& tracker = scene.surface.tracker;
  const double a_vertex = stages(tracker.integrator) * kTrackerSecondsPerVertexStage +
                          (tracker.fairing.iterations + 1) * kTrackerSecondsPerVertexFairing;
  return vertices * static_cast<double>(scene.surface.methods.size()) * steps / scene.surface.stride *
         a_vertex;
}

/// As a number of things, at most 2^53: of walls a million kilometres long there would be more.
std::size_t count(double number) {
  return whole_within<std::size_t>(number, 0, std::size_t{1} << 53);
}

}  // namespace

SceneEstimate estimate(const Scene& scene, int threads) {
  const std::vector<TriangleSurface> walls = wall_surfaces(scene);
  const FluidParticlesAtStart start = fill_blocks(scene);
  double wall_area = 0;
  for (const TriangleSurface& wall : walls) wall_area += area_and_volume(wall.vertices, wall.triangles).area;
  double emitted = 0;
  for (const Emitter& emitter : scene.fluid.emitters) emitted += emitted_particles(emitter, scene);
  const double at_end = static_cast<double>(start.position.size()) + emitted;
  const double particles = at_end - emitted / 2;  // in the mean, for an emitter that runs all the time
  const double boundary = kBoundaryParticlesPerCell * wall_area / (scene.fluid.spacing * scene.fluid.spacing);
  const double methods = static_cast<double>(scene.surface.methods.size()),
               vertices = surface_vertices(scene);
  const double frames = scene.duration * scene.output.frames_per_second + 1;
  const double steps = solver_steps(scene, fastest_speed(scene, start, walls));

  const double one_core =
      steps * particles * kSolverSecondsPerParticleStep + tracker_seconds(scene, vertices, steps);
  SceneEstimate result;
  result.particles = start.position.size();
  result.emitted = count(emitted);
  result.boundary_particles = count(std::round(boundary));
  result.memory_bytes = count(memory(scene, at_end, boundary, vertices));
  result.seconds =
      one_core * (1 - kParallelShare + kParallelShare / threads) +
      frames * (particles * kOutputSecondsPerParticle + methods * vertices * kOutputSecondsPerVertex);
  return result;
}

}  // namespace kappaflow
