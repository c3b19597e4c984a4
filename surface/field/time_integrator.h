// By what points are moved through a step.
#pragma once

#include "core/named.h"

namespace kappaflow {

/// Time integration of points: explicit Runge-Kutta of order 1, 2 (midpoint) or 4 (classical).
enum class TimeIntegrator { euler, rk2, rk4 };

/// What scenes call them.
inline constexpr Named<TimeIntegrator> kIntegrators[] = {
    {"euler", TimeIntegrator::euler}, {"rk2", TimeIntegrator::rk2}, {"rk4", TimeIntegrator::rk4}};

}  // namespace kappaflow
