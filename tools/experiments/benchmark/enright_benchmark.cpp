// Time per point of the exact field of Enright's test.
#include <benchmark/benchmark.h>

#include <random>

#include "tools/experiments/enright_flow.h"

namespace {

using namespace kappaflow;

/// Points of the unit cube at half time of Enright's test, where the flow map is the longest.
template <class Evaluate>
void run_on_enright(benchmark::State& state, const Evaluate& evaluate) {
  const EnrightField field(EnrightFlow::kPeriod / 2);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(0, 1);
  for (auto _ : state)
    benchmark::DoNotOptimize(evaluate(field, Vec3(along(random), along(random), along(random))));
  state.SetItemsProcessed(state.iterations());
}

void enright_jet(benchmark::State& state) {
  run_on_enright(state, [](const EnrightField& field, const Vec3& x) { return field.jet(x); });
}
BENCHMARK(enright_jet);

void enright_value_and_gradient(benchmark::State& state) {
  run_on_enright(state, [](const EnrightField& field, const Vec3& x) { return field.value_and_gradient(x); });
}
BENCHMARK(enright_value_and_gradient);

}  // namespace
