// Time per vertex of the phases of a tracker step and of the velocity methods on one core: a rolling ball of
// particles with sigma = 2 spacings, vertices 0.3 sigma apart.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <random>

#include "surface/field/particle_motion.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"

namespace {

using namespace kappaflow;

constexpr double kSpacing = 0.1, kStep = 0.02;
constexpr ParticleFieldOptions kField{.sigma = 2 * kSpacing, .threshold = 2.6};

Particles ball(double time) {
  Particles particles;
  particles.time = time;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-0.2 * kSpacing, 0.2 * kSpacing);
  const Vec3 velocity(1, 0, 0), spin(0, 0, -1);
  const Mat3 rotation = Eigen::AngleAxisd(time * spin.norm(), spin.normalized()).toRotationMatrix();
  constexpr int kHalf = 12;
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j)
      for (int k = -kHalf; k <= kHalf; ++k) {
        const Vec3 start = kSpacing * Vec3(i, j, k) + Vec3(jitter(random), jitter(random), jitter(random));
        if (start.norm() > kHalf * kSpacing) continue;
        particles.id.push_back(static_cast<std::int64_t>(particles.id.size()));
        particles.position.push_back(rotation * start + time * velocity);
        particles.velocity.push_back(velocity + spin.cross(rotation * start));
      }
  return particles;
}

void per_vertex(benchmark::State& state, const char* name, double seconds, std::size_t vertices) {
  state.counters[name] =
      1e6 * seconds / static_cast<double>(vertices) / static_cast<double>(state.iterations());
}

/// Microseconds a vertex: velocity_us, fairing_us (with the projections) and their sum step_us.
void tracker_step(benchmark::State& state) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const Particles at_t0 = ball(0), at_t1 = ball(kStep);
  ParticleMotion motion(at_t0, at_t1, kField);
  for (const double t : {0.0, 0.5 * kStep, kStep}) benchmark::DoNotOptimize(motion.at(t));
  const TriangleMesh mesh = initial_mesh(*motion.at(0), 0.3 * kField.sigma, {});
  double velocity = 0, fairing = 0;
  for (auto _ : state) {
    state.PauseTiming();
    SurfaceTracker tracker(
        mesh, {.method = evaluate_curvature, .fairing = {.iterations = static_cast<int>(state.range(0))}});
    state.ResumeTiming();
    const TrackerStep step = tracker.step(motion);
    velocity += step.velocity_seconds;
    fairing += step.fairing_seconds;
  }
  state.counters["vertices"] = static_cast<double>(mesh.vertex_count());
  per_vertex(state, "velocity_us", velocity, mesh.vertex_count());
  per_vertex(state, "fairing_us", fairing, mesh.vertex_count());
  per_vertex(state, "step_us", velocity + fairing, mesh.vertex_count());
}
BENCHMARK(tracker_step)->Arg(0)->Arg(2)->Arg(5)->Arg(10)->Unit(benchmark::kMillisecond);

void initial_mesh_of_a_ball(benchmark::State& state) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const std::shared_ptr<const Field> field = particle_field(ball(0), kField);
  std::size_t vertices = 0;
  for (auto _ : state) vertices = initial_mesh(*field, 0.3 * kField.sigma, {}).vertex_count();
  state.counters["us_a_vertex"] =
      benchmark::Counter(1e-6 * static_cast<double>(vertices),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(initial_mesh_of_a_ball)->Unit(benchmark::kMillisecond);

void state_of_a_ball(benchmark::State& state) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const std::shared_ptr<const Field> field = particle_field(ball(0), kField);
  const TriangleMesh mesh = initial_mesh(*field, 0.3 * kField.sigma, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  for (auto _ : state)
    benchmark::DoNotOptimize(surface_state(*field, mesh, rings, velocity_method("curvature").evaluate, {}));
}
BENCHMARK(state_of_a_ball)->Unit(benchmark::kMillisecond);

/// Time of one evaluation on the vertices of a ball's surface, range(0) hundredths of sigma apart.
void method(benchmark::State& state, const VelocityMethod& method) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const std::shared_ptr<const Field> field = particle_field(ball(0), kField);
  const double spacing = 0.01 * static_cast<double>(state.range(0)) * kField.sigma;
  const TriangleMesh mesh = initial_mesh(*field, spacing, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const std::vector<double> area = vertex_areas(mesh.position, mesh.triangles);
  SurfaceVelocities velocities;
  for (auto _ : state)
    method.evaluate(*field, {mesh.position, area, rings}, {}, velocities.sized(mesh.vertex_count()));
  state.counters["us_a_vertex"] =
      benchmark::Counter(1e-6 * static_cast<double>(mesh.vertex_count()),
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

const bool kMethodsRegistered = [] {
  for (const VelocityMethod& m : velocity_methods())
    benchmark::RegisterBenchmark(("method/" + std::string(m.name)).c_str(), method, m)
        ->Arg(30)
        ->Arg(10)
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
