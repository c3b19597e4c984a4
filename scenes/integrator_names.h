// The time integrators by the names that scene and experiment files use.
#pragma once

#include "scenes/toml_reader.h"
#include "surface/tracker/runge_kutta.h"

namespace kappaflow {

inline constexpr Named<TimeIntegrator> kIntegrators[] = {
    {"euler", TimeIntegrator::euler}, {"rk2", TimeIntegrator::rk2}, {"rk4", TimeIntegrator::rk4}};

constexpr std::string_view integrator_name(TimeIntegrator integrator) {
  for (const auto& named : kIntegrators)
    if (named.value == integrator) return named.name;
  return {};
}

}  // namespace kappaflow
