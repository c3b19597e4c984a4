#include "tools/runs/liquid.h"

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {

bool SurfacePace::may_wait(const Particles& now, double time_step) {
  const double way = fast_speed(now) * time_step;
  way_ += way;
  return way_ + way <= most_;
}

LiquidRecord OwnLiquid::record() const {
  const std::vector<double> temperature = fluid_.temperatures();
  return {{fluid_.particles(), fluid_.densities(), fluid_.pressures(), fluid_.sources(),
           std::vector<float>(temperature.begin(), temperature.end())},
          fluid_.fluids(),
          fluid_.taken(),
          fluid_.bodies()};
}

LiquidStep OwnLiquid::step(double until, bool /*last*/) {
  LiquidStep result;
  result.seconds = seconds_of([&] { result.last = fluid_.step(until - time()); });
  result.now = fluid_.particles();
  result.surfaces_follow = !pace().may_wait(result.now, result.last.time_step) || is_reached(time(), until);
  if (result.surfaces_follow) pace().follow();
  return result;
}

FluidSolver make_fluid(PreparedScene& prepared, Ranks* ranks) {
  FluidParticlesAtStart start = std::move(prepared.start);
  if (ranks != nullptr && ranks->rank() > 0) start = {};  // they come from the first
  return {prepared.scene.fluid, start.position,    start.velocity,  prepared.walls, start.fluid,
          start.source,         start.temperature, prepared.bodies, ranks};
}

std::unique_ptr<Liquid> own_liquid(PreparedScene& prepared, Ranks* ranks) {
  const int sharing = ranks != nullptr ? ranks->size() : 1;
  return std::make_unique<OwnLiquid>(prepared.scene, make_fluid(prepared, ranks), sharing);
}

int last_frame_of(const Scene& scene) {
  return static_cast<int>(std::ceil(scene.duration * scene.output.frames_per_second - 1e-9));
}

double frame_time(const Scene& scene, int frame) {
  return std::min(frame / scene.output.frames_per_second, scene.duration);
}

}  // namespace kappaflow
