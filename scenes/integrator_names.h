// The time integrators by the names that scene and experiment files use.
#pragma once

#include "scenes/toml_reader.h"
#include "surface/tracker/runge_kutta.h"

namespace kappaflow {

inline constexpr Named<TimeIntegrator> kIntegrators[] = {
    {"euler", TimeIntegrator::euler}, {"rk2", TimeIntegrator::rk2}, {"rk4", TimeIntegrator::rk4}};

}  // namespace kappaflow
