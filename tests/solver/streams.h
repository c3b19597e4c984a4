// Emitters and solvers that step, for the tests of what flows in and out.
#pragma once

#include <tbb/global_control.h>

#include <memory>
#include <sstream>

#include "core/saved_state.h"
#include "solver/fluid_solver.h"

namespace kappaflow::test {

inline Emitter downward(double radius, double speed) {
  Emitter e;
  e.mouth = DiscMouth{radius};
  e.speed = speed;
  return e;
}

/// Adds a stream along x into a box, with a ball on its way that takes its middle.
inline void add_stream(FluidOptions& o) {
  Emitter e;
  e.mouth = RectangleMouth{6 * o.spacing, 6 * o.spacing};
  e.direction = Vec3::UnitX();
  e.speed = 2;
  e.source = 4;
  o.emitters = {e};
  o.outflows = {{BoxShape{Vec3(0.4, -1, -1), Vec3(1, 1, 1)}}, {SphereShape{Vec3(0.3, 0, 0), 0.06}}};
}

inline void run(FluidSolver& s, double time) {
  while (s.time() < time) s.step(time - s.time());
}

/// The liquid of emitters after so many steps. saved: it is saved and read back after each of them.
inline std::unique_ptr<FluidSolver> after_steps(const FluidOptions& options, int steps, std::size_t threads,
                                                bool saved) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  auto s = std::make_unique<FluidSolver>(FluidSolver(options, {}, {}, {}));
  for (int k = 0; k < steps; ++k) {
    s->step(1);
    if (!saved) continue;
    std::stringstream state;
    StateWriter(state, little_endian())(*s);
    s = std::make_unique<FluidSolver>(FluidSolver(options, {}, {}, {}));
    StateReader archive(state);
    archive(*s);
  }
  return s;
}

}  // namespace kappaflow::test
