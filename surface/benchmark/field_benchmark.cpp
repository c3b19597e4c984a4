// Time per surface point of the field, for a cube of particles with sigma = 2 spacings.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <random>

#include "surface/field/particle_motion.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"

namespace {

using namespace kappaflow;

constexpr double kSpacing = 0.1, kSigma = 2 * kSpacing;

/// A rolling cube of jittered particles and points near its surface, each evaluated on one core.
struct Scene {
  explicit Scene(int side) : field(particles(side), 2.6, 0.0) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> along(0, (side - 1) * kSpacing), off(0, 0.3 * kSpacing);
    std::uniform_int_distribution<int> face(0, 5);
    for (int i = 0; i < 4096; ++i) {
      Vec3 x(along(random), along(random), along(random));
      const int f = face(random);
      x[f / 2] = f % 2 == 0 ? -off(random) : (side - 1) * kSpacing + off(random);
      points.push_back(x);
    }
  }

  static FieldParticles particles(int side) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> jitter(-0.2 * kSpacing, 0.2 * kSpacing);
    FieldParticles p;
    for (int i = 0; i < side * side * side; ++i) {
      p.position.push_back(kSpacing * Vec3(i % side, i / side % side, i / side / side) +
                           Vec3(jitter(random), jitter(random), jitter(random)));
      p.velocity.push_back(Vec3(0.3, 1, -0.2).cross(p.position.back()));
    }
    p.sigma.assign(p.position.size(), kSigma);
    p.weight.assign(p.position.size(), 1.0);
    p.weight_rate.assign(p.position.size(), 0.0);
    return p;
  }

  tbb::global_control one_core{tbb::global_control::max_allowed_parallelism, 1};
  ParticleField field;
  std::vector<Vec3> points;
};

/// Reports the time of one point; `evaluate` is called with points in turn.
template <class Evaluate>
void run_pointwise(benchmark::State& state, const Evaluate& evaluate) {
  const Scene scene(static_cast<int>(state.range(0)));
  std::size_t i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(evaluate(scene.field, scene.points[i++ % scene.points.size()]));
  state.SetItemsProcessed(state.iterations());
}

void jet(benchmark::State& state) {
  run_pointwise(state, [](const ParticleField& field, const Vec3& x) { return field.jet(x); });
}
BENCHMARK(jet)->Arg(20)->Arg(47);

void jet_and_strain_response(benchmark::State& state) {
  StrainResponse strain;
  run_pointwise(state, [&](const ParticleField& field, const Vec3& x) { return field.jet(x, strain); });
}
BENCHMARK(jet_and_strain_response)->Arg(20)->Arg(47);

/// The jet once, and from it the velocities normal, total and curvature (closed form).
void jet_and_three_velocities(benchmark::State& state) {
  const VelocityOptions options;
  run_pointwise(state, [&](const ParticleField& field, const Vec3& x) {
    const Jet jet = field.jet(x);
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, options);
    const TangentialRows<2> total = total_rows(jet, basis, v_n, jet.length_scale);
    const TangentialRows<4> all = stacked(total, curvature_rows(jet, basis, v_n, jet.length_scale));
    const Vec3 v_t = basis * solve_damped(total, options.damping).y;
    const Vec3 v_c = basis * solve_damped(all, options.damping).y;
    return Eigen::Matrix3d{
        {v_n.x(), v_n.y(), v_n.z()}, {v_t.x(), v_t.y(), v_t.z()}, {v_c.x(), v_c.y(), v_c.z()}};
  });
}
BENCHMARK(jet_and_three_velocities)->Arg(20)->Arg(47);

void value_and_gradient(benchmark::State& state) {
  run_pointwise(state, [](const ParticleField& field, const Vec3& x) { return field.value_and_gradient(x); });
}
BENCHMARK(value_and_gradient)->Arg(20)->Arg(47);

void first_order_jet(benchmark::State& state) {
  run_pointwise(state, [](const ParticleField& field, const Vec3& x) { return field.first_order_jet(x); });
}
BENCHMARK(first_order_jet)->Arg(20)->Arg(47);

void material_velocity(benchmark::State& state) {
  run_pointwise(state, [](const ParticleField& field, const Vec3& x) { return field.material_velocity(x); });
}
BENCHMARK(material_velocity)->Arg(20)->Arg(47);

void moving_point(benchmark::State& state) {
  run_pointwise(state, [](const ParticleField& field, const Vec3& x) { return field.moving_point(x); });
}
BENCHMARK(moving_point)->Arg(20)->Arg(47);

/// As run_pointwise(), of the same particles with anisotropic kernels.
template <class Evaluate>
void run_anisotropic(benchmark::State& state, const Evaluate& evaluate) {
  const int side = static_cast<int>(state.range(0));
  const Scene scene(side);
  const auto field = particle_field(Scene::particles(side), Kernels::anisotropic, 2.6, 0);
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(evaluate(*field, scene.points[i++ % scene.points.size()]));
  state.SetItemsProcessed(state.iterations());
}

void anisotropic_jet(benchmark::State& state) {
  run_anisotropic(state, [](const Field& field, const Vec3& x) { return field.jet(x); });
}
BENCHMARK(anisotropic_jet)->Arg(20)->Arg(47);

void anisotropic_first_order_jet(benchmark::State& state) {
  run_anisotropic(state, [](const Field& field, const Vec3& x) { return field.first_order_jet(x); });
}
BENCHMARK(anisotropic_first_order_jet)->Arg(20)->Arg(47);

void anisotropic_value_and_gradient(benchmark::State& state) {
  run_anisotropic(state, [](const Field& field, const Vec3& x) { return field.value_and_gradient(x); });
}
BENCHMARK(anisotropic_value_and_gradient)->Arg(20)->Arg(47);

void make_kernel_shapes(benchmark::State& state) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const FieldParticles particles = Scene::particles(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(kernel_shapes(particles, 2.6).weight.front());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(particles.position.size()));
}
BENCHMARK(make_kernel_shapes)->Arg(20)->Arg(47)->Unit(benchmark::kMillisecond);

void build_field(benchmark::State& state) {
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const FieldParticles particles = Scene::particles(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(ParticleField(particles, 2.6, 0.0).fastest_speed());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(particles.position.size()));
}
BENCHMARK(build_field)->Arg(47)->Unit(benchmark::kMillisecond);

void sample_lattice(benchmark::State& state) {
  const Scene scene(static_cast<int>(state.range(0)));
  SampledField samples;
  const Bounds bounds = scene.field.bounds();
  samples.origin = bounds.lower;
  samples.spacing = 0.25 * kSigma;
  for (int a = 0; a < 3; ++a)
    samples.dims[a] = 1 + static_cast<int>((bounds.upper - bounds.lower)[a] / samples.spacing);
  for (auto _ : state) scene.field.sample(samples);
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(0) * state.range(0));
}
BENCHMARK(sample_lattice)->Arg(47)->Unit(benchmark::kMillisecond);

}  // namespace
