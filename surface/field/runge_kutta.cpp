#include "surface/field/runge_kutta.h"

#include <array>

namespace kappaflow {

std::span<const RungeKuttaStage> runge_kutta_stages(TimeIntegrator integrator) {
  static constexpr std::array<RungeKuttaStage, 1> euler{{{0, 1}}};
  static constexpr std::array<RungeKuttaStage, 2> midpoint{{{0, 0}, {0.5, 1}}};
  static constexpr std::array<RungeKuttaStage, 4> classical{
      {{0, 1. / 6}, {0.5, 1. / 3}, {0.5, 1. / 3}, {1, 1. / 6}}};
  switch (integrator) {
    case TimeIntegrator::euler:
      return euler;
    case TimeIntegrator::rk2:
      return midpoint;
    case TimeIntegrator::rk4:
      break;
  }
  return classical;
}

}  // namespace kappaflow
