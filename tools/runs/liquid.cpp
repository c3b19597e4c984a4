#include "tools/runs/liquid.h"

#include <algorithm>
#include <cmath>

#include "core/stopwatch.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {

bool SurfacePace::may_wait(double speed, double time_step) {
  const double way = speed * time_step;
  way_ += way;
  return way_ + way <= most_;
}

ParticleFrame particle_frame(const FluidSolver& fluid, Whose whose) {
  const std::vector<double> temperature = fluid.temperatures(whose);
  return {fluid.particles(whose), fluid.densities(whose), fluid.pressures(whose), fluid.sources(whose),
          std::vector<float>(temperature.begin(), temperature.end())};
}

LiquidRecord OwnLiquid::record() const {
  LiquidRecord record;
  record.particles = particle_frame(fluid_);
  record.count = record.particles.particles.size();
  record.compression = compression(record.particles.density, fluid_.fluids(), options_);
  record.temperature = temperature_range(record.particles.temperature);
  record.taken = fluid_.taken();
  record.bodies = fluid_.bodies();
  return record;
}

LiquidStep OwnLiquid::step(double until, bool /*last*/) {
  LiquidStep result;
  result.seconds = seconds_of([&] { result.last = fluid_.step(until - time()); });
  const double speed = fluid_.fast_speed(kShareOfFast);
  const bool in_frame = is_reached(time(), until);
  result.surfaces_follow = !pace().may_wait(speed, result.last.time_step) || in_frame;
  if (result.surfaces_follow) pace().follow();
  if (result.surfaces_follow && !in_frame) result.now = particles();
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

bool has_checkpoint(const Scene& scene, int frame) {
  return frame % scene.output.checkpoint_interval == 0 || frame == last_frame_of(scene);
}

double frame_time(const Scene& scene, int frame) {
  return std::min(frame / scene.output.frames_per_second, scene.duration);
}

}  // namespace kappaflow
